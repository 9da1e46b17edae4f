#pragma once

#include "cairn/planar/increment.hpp"

namespace cairn {

/// Increments of an Ackermann vehicle whose noise is linearised at low-passed readings instead of
/// at the reading itself. Turn is v dt tan(phi) / L: at a noisy steering reading the covariance of
/// distance and turn has the sign of that reading's own error, which a filter takes for
/// information.
template <class T>
class SteadyAckermann {
 public:
  /// `steady_s`: time constant of the low pass, s, >= 0; 0 linearises at the reading.
  explicit SteadyAckermann(T steady_s) : steady_s_(steady_s) {}

  /// Arguments, domain and refusal as ackermann_increment(). A refused reading does not enter the
  /// low pass.
  PlanarIncrement<T> increment(T v, T phi, T dt, T wheelbase, T sigma_v, T sigma_phi,
                               IncrementModel model = IncrementModel::kEuler) {
    PlanarIncrement<T> increment =
        ackermann_increment(v, phi, dt, wheelbase, sigma_v, sigma_phi, model);
    if (!ok(validate(increment))) return increment;
    const T share = !has_reading_ ? T(1) : dt > T(0) ? dt / (dt + steady_s_) : T(0);
    v_ += share * (v - v_);
    phi_ += share * (phi - phi_);
    has_reading_ = true;
    increment.covariance =
        ackermann_increment(v_, phi_, dt, wheelbase, sigma_v, sigma_phi, model).covariance;
    return increment;
  }

 private:
  T steady_s_;
  T v_ = T(0);
  T phi_ = T(0);
  bool has_reading_ = false;
};

}  // namespace cairn
