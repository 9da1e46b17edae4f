#include "host_sim/evaluation/planar_nees.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn::host {

double pose_nees(const PoseEstimate& estimate, const Pose2& truth) {
  Eigen::Vector3d error;
  error << truth.position - estimate.pose.position,
      wrap_angle(truth.heading - estimate.pose.heading);
  return error.dot(estimate.covariance.ldlt().solve(error));
}

double landmark_nees(const LandmarkEstimate& estimate, const Eigen::Vector2d& truth) {
  const Eigen::Vector2d error = truth - estimate.position;
  return error.dot(estimate.covariance.ldlt().solve(error));
}

}  // namespace cairn::host
