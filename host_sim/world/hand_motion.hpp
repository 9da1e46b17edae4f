#pragma once

#include <array>
#include <cstdint>

#include "cairn/geometry/rigid.hpp"

namespace cairn::host {

/// A camera in the hand of someone who stands in the hall before a bookshelf and looks about:
/// smooth for all times, sums of sines whose phases follow the seed. It moves at up to 0.4 m/s and
/// turns at up to 1.3 rad/s.
class HandMotion {
 public:
  explicit HandMotion(std::uint64_t seed);

  /// T_world_camera.
  Rigid<double> pose_at_time(double t_s) const;

 private:
  struct Sine {
    double amplitude;
    double rate_radps;
    double phase_rad;
  };
  /// Two sines: swaying, and trembling.
  using Axis = std::array<Sine, 2>;
  static double at(const Axis& axis, double t_s);

  std::array<Axis, 3> position_;  ///< world axes, m
  std::array<Axis, 3> turn_;      ///< camera axes, rad
};

}  // namespace cairn::host
