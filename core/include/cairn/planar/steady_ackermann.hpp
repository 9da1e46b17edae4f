#pragma once

#include "cairn/planar/increment.hpp"

namespace cairn {

/// Low pass of a vehicle's odometry readings: speed, and steering angle or yaw rate.
template <class T>
class SteadyReading {
 public:
  /// `steady_s`: time constant, s, >= 0; 0 follows the readings.
  explicit SteadyReading(T steady_s = T(0)) : steady_s_(steady_s) {}

  /// A reading taken `dt` seconds after the one before. The first is taken as it is.
  void take(T speed, T turn, T dt) {
    const T share = !has_reading_ ? T(1) : dt > T(0) ? dt / (dt + steady_s_) : T(0);
    speed_ += share * (speed - speed_);
    turn_ += share * (turn - turn_);
    has_reading_ = true;
  }
  T speed() const { return speed_; }
  T turn() const { return turn_; }

 private:
  T steady_s_;
  T speed_ = T(0);
  T turn_ = T(0);
  bool has_reading_ = false;
};

/// Increments of an Ackermann vehicle whose noise is linearised at low-passed readings instead of
/// at the reading itself. Turn is v dt tan(phi) / L: at a noisy steering reading the covariance of
/// distance and turn has the sign of that reading's own error, which a filter takes for
/// information.
template <class T>
class SteadyAckermann {
 public:
  /// `steady_s`: time constant of the low pass, s, >= 0; 0 linearises at the reading.
  explicit SteadyAckermann(T steady_s) : steady_(steady_s) {}

  /// Arguments, domain and refusal as ackermann_increment(). A refused reading does not enter the
  /// low pass.
  PlanarIncrement<T> increment(T v, T phi, T dt, T wheelbase, T sigma_v, T sigma_phi,
                               IncrementModel model = IncrementModel::kEuler) {
    PlanarIncrement<T> increment =
        ackermann_increment(v, phi, dt, wheelbase, sigma_v, sigma_phi, model);
    if (!ok(validate(increment))) return increment;
    steady_.take(v, phi, dt);
    increment.covariance = ackermann_increment(steady_.speed(), steady_.turn(), dt, wheelbase,
                                               sigma_v, sigma_phi, model)
                               .covariance;
    return increment;
  }

 private:
  SteadyReading<T> steady_;
};

}  // namespace cairn
