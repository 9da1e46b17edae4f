#pragma once

#include "cairn/planar/increment.hpp"
#include "cairn/planar/reading_low_pass.hpp"

namespace cairn {

/// Increments of an Ackermann vehicle whose noise is linearised at low-passed readings instead of
/// at the reading itself. Turn is v dt tan(phi) / L: at a noisy steering reading the covariance of
/// distance and turn has the sign of that reading's own error, which a filter takes for
/// information.
template <class T>
class SteadyAckermann {
 public:
  /// `steady_s`: time constant of the low pass, s, >= 0; 0 linearises at the reading.
  explicit SteadyAckermann(T steady_s) : low_pass_(steady_s) {}

  /// Arguments, domain and refusal as ackermann_increment(). A refused reading does not enter the
  /// low pass.
  PlanarIncrement<T> increment(T v, T phi, T dt, T wheelbase, T sigma_v, T sigma_phi,
                               IncrementModel model = IncrementModel::kEuler) {
    PlanarIncrement<T> increment =
        ackermann_increment(v, phi, dt, wheelbase, sigma_v, sigma_phi, model);
    if (!ok(validate(increment))) return increment;
    low_pass_.add(v, phi, dt);
    increment.covariance = ackermann_increment(low_pass_.speed(), low_pass_.turn(), dt, wheelbase,
                                               sigma_v, sigma_phi, model)
                               .covariance;
    return increment;
  }

 private:
  ReadingLowPass<T> low_pass_;
};

}  // namespace cairn
