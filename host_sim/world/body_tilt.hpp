#pragma once

#include <cstdint>

#include "cairn/planar/tilt.hpp"

#include "host_sim/world/gaussian.hpp"

namespace cairn::host {

/// Tilt of a vehicle's body over time: pitch and roll as first-order Gauss-Markov processes that
/// begin in their stationary state. Same parameters and seed, same numbers.
class BodyTilt {
 public:
  BodyTilt(const TiltParameters<double>& parameters, std::uint64_t seed)
      : parameters_(parameters), random_(seed) {
    if (!parameters.tilts()) return;
    tilt_.pitch = random_.normal(parameters.sigma_pitch_rad);
    tilt_.roll = random_.normal(parameters.sigma_roll_rad);
  }

  const VehicleTilt<double>& tilt() const { return tilt_; }
  void advance(double dt_s) {
    if (!parameters_.tilts()) return;
    const double decay = parameters_.decay(dt_s);
    const Vector2<double> noise = parameters_.noise(decay);
    tilt_.pitch = decay * tilt_.pitch + random_.normal(cairn::sqrt(noise(0)));
    tilt_.roll = decay * tilt_.roll + random_.normal(cairn::sqrt(noise(1)));
  }

 private:
  TiltParameters<double> parameters_;
  GaussianRandom random_;
  VehicleTilt<double> tilt_;
};

}  // namespace cairn::host
