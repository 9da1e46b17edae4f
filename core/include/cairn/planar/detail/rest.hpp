#pragma once

#include "cairn/planar/increment.hpp"

namespace cairn::detail {

/// A vehicle at rest, by odometry: since the last update that was applied or confirmed, every
/// increment was exactly no motion. The noise of these increments is held back: the errors of a
/// wheel that stands do not add up, and sightings that agree with rest prove that there was none.
template <class T>
class Rest {
 public:
  /// Forgets the rest; what is usual stays.
  void clear() {
    const T usual = usual_;
    *this = Rest();
    usual_ = usual;
  }
  bool resting() const { return resting_; }

  /// An update settled the pose here.
  void begin() {
    clear();
    resting_ = true;
  }
  /// Holds the time in which the body may tilt; false where the vehicle does not rest.
  bool hold_time(T dt_s) {
    if (resting_) held_s_ += dt_s;
    return resting_;
  }
  T held_s() const { return held_s_; }
  /// The noise that is held, as an increment; there is none afterwards, and no rest.
  PlanarIncrement<T> end() {
    const PlanarIncrement<T> held = held_;
    clear();
    return held;
  }
  /// Whether an increment is held. False: it moves the vehicle, or what is held grew too large.
  bool hold(const PlanarIncrement<T>& increment) {
    if (!resting_ || increment.distance_m != T(0) || increment.turn_rad != T(0)) return false;
    const Matrix2<T> sum = held_.covariance + increment.covariance;
    if (sum(0, 0) > kMostDistanceVariance || sum(1, 1) > kMostTurnVariance) return false;
    held_.covariance = sum;
    return true;
  }
  /// An update of a moving vehicle: its normalised innovations, summed over `rows`.
  void note_moving(T nis, int rows) {
    if (rows > 0) usual_ += kGain * (nis / static_cast<T>(rows) - usual_);
  }
  /// Whether innovations agree with rest: with what the noise allows, and where pictures of the
  /// moving vehicle agree far better than that, with some times what is usual. A vehicle that
  /// creeps while its wheels say rest moves pixels by less than the noise at first.
  bool agrees(T nis, int rows, T sigmas) const {
    const T expected = static_cast<T>(rows);
    const T share = kTimesUsual * usual_ < T(1) ? kTimesUsual * usual_ : T(1);
    return nis <= share * (expected + sigmas * sqrt(T(2) * expected));
  }
  bool holds_noise() const {
    return held_.covariance(0, 0) > T(0) || held_.covariance(1, 1) > T(0);
  }
  const PlanarIncrement<T>& held() const { return held_; }

 private:
  static constexpr T kMostDistanceVariance = T(4e-4);  ///< m^2
  static constexpr T kMostTurnVariance = T(1e-4);      ///< rad^2

  static constexpr T kGain = T(0.1);  ///< ten updates
  static constexpr T kTimesUsual = T(4);

  bool resting_ = false;
  PlanarIncrement<T> held_;
  T held_s_ = T(0);
  T usual_ = T(1);  ///< innovation per row of a moving vehicle, low-passed
};

}  // namespace cairn::detail
