#include "host_sim/experiments/consistency/reference/invariant_ekf.hpp"

#include <cmath>

#include "cairn/numeric/math.hpp"

namespace cairn::host {

void InvariantEkf::initialise(const Pose2& pose, const Eigen::Matrix3d& covariance) {
  heading_ = pose.heading;
  points_ = pose.position;
  slots_ = SlotTable();
  Eigen::Matrix3d t = Eigen::Matrix3d::Zero();
  t(0, 2) = 1.0;
  t.block<2, 2>(1, 0).setIdentity();
  t.block<2, 1>(1, 2) = -rotation_generator() * pose.position;
  covariance_ = t * covariance * t.transpose();
}

void InvariantEkf::predict(const Increment& step) {
  const Eigen::Vector2d direction(std::cos(heading_), std::sin(heading_));
  points_.head<2>() += step.distance_m * direction;
  heading_ = wrap_angle(heading_ + step.turn_rad);
  Eigen::MatrixXd g = Eigen::MatrixXd::Zero(covariance_.rows(), 2);
  g(0, 1) = 1.0;
  g.block<2, 1>(1, 0) = direction;
  for (Eigen::Index i = 0; i < points_.size(); i += 2) {
    g.block<2, 1>(1 + i, 1) = -rotation_generator() * points_.segment<2>(i);
  }
  covariance_ += g * step.covariance * g.transpose();
}

void InvariantEkf::update(const std::vector<PointSighting>& sightings, double sigma_m) {
  std::vector<DenseRow> rows;
  const Eigen::Matrix2d to_world = rotation2(heading_);
  for (const auto& s : sightings) {
    const int slot = slots_.find(s.landmark);
    if (slot < 0) continue;
    DenseRow row;
    row.landmark_column = 3 + 2 * slot;
    row.vehicle = Eigen::MatrixXd::Zero(2, 3);
    row.vehicle.rightCols<2>() = -Eigen::Matrix2d::Identity();
    row.innovation = to_world * s.point - (points_.segment<2>(2 + 2 * slot) - points_.head<2>());
    row.noise = sigma_m * sigma_m * Eigen::Matrix2d::Identity();
    rows.push_back(row);
  }
  if (!rows.empty()) {
    const DenseGain gain = dense_gain(covariance_, rows);
    retract(gain.gain * gain.innovation);
    apply_gain(gain, covariance_);
  }
  for (const auto& s : sightings) {
    if (slots_.find(s.landmark) >= 0) continue;
    slots_.add(s.landmark);
    const Eigen::Index n = covariance_.rows();
    const Eigen::MatrixXd cross = covariance_.middleRows(1, 2);
    const Eigen::Matrix2d own =
        covariance_.block<2, 2>(1, 1) + sigma_m * sigma_m * Eigen::Matrix2d::Identity();
    points_.conservativeResize(n + 1);
    points_.tail<2>() = points_.head<2>() + rotation2(heading_) * s.point;
    covariance_.conservativeResize(n + 2, n + 2);
    covariance_.bottomLeftCorner(2, n) = cross;
    covariance_.topRightCorner(n, 2) = cross.transpose();
    covariance_.bottomRightCorner<2, 2>() = own;
  }
}

void InvariantEkf::retract(const Eigen::VectorXd& correction) {
  const double angle = correction(0);
  const Eigen::Matrix2d r = rotation2(angle);
  const Eigen::Matrix2d v = se2_left_jacobian(angle);
  heading_ = wrap_angle(heading_ + angle);
  for (Eigen::Index i = 0; i < points_.size(); i += 2) {
    const Eigen::Vector2d moved = r * points_.segment<2>(i) + v * correction.segment<2>(1 + i);
    points_.segment<2>(i) = moved;
  }
}

Eigen::Matrix<double, 2, 3> InvariantEkf::to_world(const Eigen::Vector2d& point) const {
  Eigen::Matrix<double, 2, 3> t;
  t.col(0) = rotation_generator() * point;
  t.rightCols<2>().setIdentity();
  return t;
}

PoseEstimate InvariantEkf::pose() const {
  Eigen::Matrix3d t = Eigen::Matrix3d::Zero();
  t.topRows<2>() = to_world(points_.head<2>());
  t(2, 0) = 1.0;
  return {{points_.head<2>(), heading_}, t * covariance_.topLeftCorner<3, 3>() * t.transpose()};
}

bool InvariantEkf::landmark(int landmark, LandmarkEstimate& estimate) const {
  const int slot = slots_.find(landmark);
  if (slot < 0) return false;
  const Eigen::Index column = 3 + 2 * slot;
  estimate.position = points_.segment<2>(column - 1);
  Eigen::Matrix3d marginal;
  marginal(0, 0) = covariance_(0, 0);
  marginal.block<1, 2>(0, 1) = covariance_.block<1, 2>(0, column);
  marginal.block<2, 1>(1, 0) = covariance_.block<2, 1>(column, 0);
  marginal.block<2, 2>(1, 1) = covariance_.block<2, 2>(column, column);
  const Eigen::Matrix<double, 2, 3> t = to_world(estimate.position);
  estimate.covariance = t * marginal * t.transpose();
  return true;
}

}  // namespace cairn::host
