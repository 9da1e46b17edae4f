#pragma once

#include "cairn/planar/fixed/fixed_ekf_slam.hpp"
#include "cairn/planar/fixed/fixed_group_slam.hpp"

#include "host_sim/base/planar_types.hpp"

// Between double and the messages of the planar filter without floating point.

namespace cairn::host {

inline FixedPose to_fixed(const Pose2& pose) {
  return {FixedCoordinate::nearest(pose.position.x()), FixedCoordinate::nearest(pose.position.y()),
          FixedAngle::nearest(pose.heading)};
}
inline Pose2 to_double(const FixedPose& pose) {
  Pose2 result;
  result.position = {pose.x.to_double(), pose.y.to_double()};
  result.heading = pose.heading.to_double();
  return result;
}

inline FixedCovariance2 to_fixed(const Eigen::Matrix2d& covariance) {
  return {FixedVariance::nearest(covariance(0, 0)), FixedVariance::nearest(covariance(1, 0)),
          FixedVariance::nearest(covariance(1, 1))};
}
inline Eigen::Matrix2d to_double(const FixedCovariance2& covariance) {
  Eigen::Matrix2d result;
  result << covariance.xx.to_double(), covariance.xy.to_double(), covariance.xy.to_double(),
      covariance.yy.to_double();
  return result;
}

inline FixedPoseCovariance to_fixed(const Eigen::Matrix3d& covariance) {
  return {to_fixed(Eigen::Matrix2d(covariance.topLeftCorner<2, 2>())),
          FixedVariance::nearest(covariance(2, 0)), FixedVariance::nearest(covariance(2, 1)),
          FixedVariance::nearest(covariance(2, 2))};
}
inline Eigen::Matrix3d to_double(const FixedPoseCovariance& covariance) {
  Eigen::Matrix3d result;
  result.topLeftCorner<2, 2>() = to_double(covariance.position);
  result(2, 0) = covariance.x_heading.to_double();
  result(2, 1) = covariance.y_heading.to_double();
  result(2, 2) = covariance.heading.to_double();
  result(0, 2) = result(2, 0);
  result(1, 2) = result(2, 1);
  return result;
}

inline FixedIncrement to_fixed(const Increment& step) {
  FixedIncrement result;
  result.distance = FixedOffset::nearest(step.distance_m);
  result.turn = FixedAngle::nearest(step.turn_rad);
  result.distance_variance = FixedVariance::nearest(step.covariance(0, 0));
  result.distance_turn = FixedVariance::nearest(step.covariance(1, 0));
  result.turn_variance = FixedVariance::nearest(step.covariance(1, 1));
  result.model = step.model;
  return result;
}

inline Eigen::Vector2d position_of(const FixedLandmark& landmark) {
  return {landmark.x.to_double(), landmark.y.to_double()};
}

}  // namespace cairn::host
