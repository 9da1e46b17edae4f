#pragma once

#include "host_sim/experiments/consistency/filter.hpp"
#include "host_sim/experiments/consistency/reference/dense_kalman.hpp"

namespace cairn::host {

/// Right-invariant EKF-SLAM (Barrau and Bonnabel 2015, arXiv 1510.06263): estimate
/// (heading, x, p_1 .. p_n), error (e, xi_x, xi_i) of the group SE_{n+1}(2), F = I, H = [0 -I I].
/// Odometry noise is added at every step, the pose is read out to first order: the plain textbook
/// form that GroupIekfSlam is compared with.
class InvariantEkf final : public FilterUnderTest {
 public:
  void initialise(const Pose2& pose, const Eigen::Matrix3d& covariance) override;
  void predict(const Increment& step) override;
  void update(const std::vector<PointSighting>& sightings, double sigma_m) override;
  PoseEstimate pose() const override;
  bool landmark(int landmark, LandmarkEstimate& estimate) const override;
  int dimension() const override { return static_cast<int>(covariance_.rows()); }

 private:
  void retract(const Eigen::VectorXd& correction);
  Eigen::Matrix<double, 2, 3> to_world(const Eigen::Vector2d& point) const;

  double heading_ = 0.0;
  Eigen::VectorXd points_;  ///< position, then landmarks
  Eigen::MatrixXd covariance_;
  SlotTable slots_;
};

}  // namespace cairn::host
