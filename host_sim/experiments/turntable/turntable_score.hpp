#pragma once

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "cairn/geometry/camera.hpp"

#include "host_sim/experiments/turntable/points_simulation.hpp"

namespace cairn::host {

/// Fills the errors of `frame`, and of the run so far in `result`, from the filter's pose.
template <class Filter>
void compare_with_truth(const Filter& filter, const TurntablePose& first, const TurntablePose& pose,
                        PointsFrame& frame, PointsResult& result) {
  constexpr double kLostDeg = 20.0;
  const auto estimate = filter.T_world_camera();
  const Eigen::Matrix3d relative = estimate.rotation.toRotationMatrix().template cast<double>();
  const Eigen::Matrix3d rotation = first.rotation * relative;
  frame.true_yaw_deg = pose.yaw_deg;
  frame.yaw_error_deg = std::remainder(yaw_deg(rotation) - yaw_deg(pose.rotation), 360.0);
  frame.pitch_error_deg = pitch_deg(rotation) - pitch_deg(pose.rotation);
  const Eigen::AngleAxisd error(Eigen::Matrix3d(rotation.transpose() * pose.rotation));
  frame.attitude_error_deg = rotation_angle_deg(error.toRotationMatrix());
  const Eigen::Matrix3d covariance =
      filter.pose_covariance().template cast<double>().template bottomRightCorner<3, 3>();
  const Eigen::Vector3d phi = error.angle() * error.axis();
  frame.attitude_nees = phi.dot((covariance + 1e-16 * Eigen::Matrix3d::Identity()).inverse() * phi);
  frame.features = filter.feature_count();
  frame.fading_factor = static_cast<double>(filter.last_fading_factor());
  result.mean_features += frame.features;
  result.lost = !std::isfinite(frame.attitude_error_deg) || frame.attitude_error_deg > kLostDeg;
  const Eigen::Vector3d moved = estimate.translation.template cast<double>();
  const Eigen::Vector3d truth = first.rotation.transpose() * (pose.position - first.position);
  result.final_distance_m = moved.norm();
  if (truth.norm() > 0.01) result.displacement_ratio = moved.dot(truth) / truth.squaredNorm();
}

/// The figures of a finished run from its frames.
template <class Filter>
void summarise_run(const Filter& filter, double focal_px, PointsResult& r) {
  const auto n = static_cast<double>(r.frames.size());
  double nis = 0.0;
  double dof = 0.0;
  for (const PointsFrame& f : r.frames) {
    const double yaw = std::abs(f.yaw_error_deg);
    r.max_yaw_error_deg = std::max(r.max_yaw_error_deg, yaw);
    r.mean_yaw_error_deg += yaw / n;
    r.mse_yaw_error_deg2 += yaw * yaw / n;
    r.mean_pitch_error_deg += std::abs(f.pitch_error_deg) / n;
    r.mean_attitude_error_deg += f.attitude_error_deg / n;
    r.max_attitude_error_deg = std::max(r.max_attitude_error_deg, f.attitude_error_deg);
    r.mean_nees += (&f == r.frames.data() ? 0.0 : f.attitude_nees) / n;
    nis += f.nis;
    dof += f.nis_dof;
  }
  r.final_yaw_error_deg = r.frames.back().yaw_error_deg;
  r.mean_nis = dof > 0.0 ? nis / dof : 0.0;
  r.focal_factor = static_cast<double>(filter.camera().fx) / focal_px;
  r.mean_hypotheses /= n;
  r.mean_features /= n;
  r.mean_filter_us /= n;
}

/// Camera as the scenario's filter believes it to be.
template <class T>
PinholeCamera<T> believed_camera(const PointsScenario& scenario) {
  PinholeCamera<T> camera;
  camera.fx = camera.fy = static_cast<T>(scenario.focal_px * (1.0 + scenario.focal_error));
  camera.cx = static_cast<T>(0.5 * (scenario.width - 1) + scenario.principal_error_px);
  camera.cy = static_cast<T>(0.5 * (scenario.height - 1));
  camera.width = scenario.width;
  camera.height = scenario.height;
  return camera;
}

}  // namespace cairn::host
