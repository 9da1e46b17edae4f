#pragma once

#include <vector>

#include <Eigen/Dense>

#include "cairn/planar/increment.hpp"
#include "cairn/planar/types.hpp"

namespace cairn::host {

/// Reference filters and experiments run in double.
using Pose2 = cairn::PlanarPose<double>;
using Increment = cairn::PlanarIncrement<double>;

/// Position of landmark `landmark` in the vehicle frame, m.
struct PointSighting {
  int landmark = 0;
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
};

/// Mean and covariance of (x, y, heading).
struct PoseEstimate {
  Pose2 pose;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
};

/// Mean and covariance of a landmark's world position.
struct LandmarkEstimate {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
};

inline Eigen::Matrix2d rotation2(double angle) {
  Eigen::Matrix2d r;
  r << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  return r;
}

/// The generator of rotations: d/dt rotation2(t) at t = 0.
inline Eigen::Matrix2d rotation_generator() {
  Eigen::Matrix2d j;
  j << 0.0, -1.0, 1.0, 0.0;
  return j;
}

/// Moves `pose` straight along its heading, then turns it: paper A, equation (4).
Pose2 advance(const Pose2& pose, double distance_m, double turn_rad);

/// Left Jacobian V(t) of SE(2): the translation part of exp is V(t) times the tangent's.
Eigen::Matrix2d se2_left_jacobian(double angle);

}  // namespace cairn::host
