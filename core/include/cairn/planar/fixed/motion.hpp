#pragma once

#include "cairn/planar/fixed/types.hpp"

namespace cairn::detail {

/// How far an increment moves the vehicle, in the world's axes, and its derivatives.
struct FixedStep {
  FixedCoordinate x;
  FixedCoordinate y;
  FixedRatio by_distance[2];
  FixedOffset by_turn[2];
};
FixedStep fixed_step(const FixedIncrement& increment, FixedAngle heading,
                     std::uint32_t& saturations);

/// Whether two variances and their covariance are positive semi-definite, but for their rounding.
bool possible(FixedVariance a, FixedVariance b, FixedVariance covariance);

/// kInvalidArgument when |turn| > pi or the covariance is not positive semi-definite.
Status validate(const FixedIncrement& increment);

/// Covariance of what odometry added since it was last absorbed, of the errors of the heading and
/// of the vehicle's own position: as small as the drive is short, wherever it is.
class FixedMotionNoise {
 public:
  bool empty() const { return heading_.raw() == 0 && own_.xx.raw() == 0 && own_.yy.raw() == 0; }
  void clear() { *this = FixedMotionNoise(); }
  void start(const FixedPoseCovariance& covariance) {
    heading_ = covariance.heading;
    x_heading_ = covariance.x_heading;
    y_heading_ = covariance.y_heading;
    own_ = covariance.position;
  }
  /// Pose errors move with the vehicle, and the increment adds its own.
  void move(const FixedIncrement& increment, const FixedStep& step, std::uint32_t& saturations);
  /// The position's error turns with the heading's over a step of (x, y).
  void turn(FixedOffset x, FixedOffset y, std::uint32_t& saturations);
  void widen(FixedVariance position, FixedVariance heading, std::uint32_t& saturations);
  /// Lateral slip: the same across a heading.
  void slip_laterally(FixedVariance variance, FixedAngle heading, std::uint32_t& saturations);

  FixedVariance heading() const { return heading_; }
  FixedVariance x_heading() const { return x_heading_; }
  FixedVariance y_heading() const { return y_heading_; }
  const FixedCovariance2& position() const { return own_; }

  /// Of the vehicle's error xi = (own position) - J p (heading) at p = (x, y): the group's.
  FixedPoseCovariance about(FixedLength x, FixedLength y, std::uint32_t& saturations) const;
  /// Adds that of the vector r = (x, y) from the vehicle to a landmark, -J r (heading) - own.
  void add_relative(FixedLength x, FixedLength y, FixedCovariance2& covariance,
                    std::uint32_t& saturations) const;

  /// The same covariance as three columns of (heading; x; y), the first with all three, the others
  /// of the position.
  struct Columns {
    FixedRoot heading;        ///< rad
    std::int64_t along[2];    ///< x and y of the first, kBits fraction bits, m
    std::int64_t rest[2][2];  ///< x and y of the second, of the third
    static constexpr int kBits = 40;
  };
  Columns columns(std::uint32_t& saturations) const;

 private:
  FixedVariance heading_;
  FixedVariance x_heading_;
  FixedVariance y_heading_;
  FixedCovariance2 own_;
};

}  // namespace cairn::detail
