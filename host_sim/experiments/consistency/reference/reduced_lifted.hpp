#pragma once

#include <array>

#include "host_sim/experiments/consistency/filter.hpp"
#include "host_sim/experiments/consistency/reference/dense_kalman.hpp"

namespace cairn::host {

/// Monomials of the odometry that the reduced model is linear in:
/// 1, u1, sin a, cos a, u1 sin a, u1 cos a (u1 = forward, a = turn).
using OdometryMonomials = Eigen::Matrix<double, 6, 1>;

/// Mean and covariance of the monomials for Gaussian (u1, a), closed form.
struct MonomialMoments {
  OdometryMonomials mean;
  Eigen::Matrix<double, 6, 6> covariance;
};
MonomialMoments monomial_moments(const Increment& step);

/// The exact quotient of paper A's 11 + 6n filter: state (x, y, sin, cos, q, q_1 .. q_n) with
/// q = R^T x and q_i = R^T p_i, 6 + 2n. Its pose and 3x3 covariance are those of the full filter.
///
/// - kJacobian: noise by first-order Jacobians, as printed in the paper.
/// - kMoments: exact moments of the start, of the motion noise, which multiplies the state
/// (Germani,
///   Manes and Palumbo 2005), and so of the prediction.
class ReducedLifted final : public FilterUnderTest {
 public:
  enum class Noise { kJacobian, kMoments };

  explicit ReducedLifted(Noise noise) : noise_(noise) {}

  void initialise(const Pose2& pose, const Eigen::Matrix3d& covariance) override;
  void predict(const Increment& step) override;
  void update(const std::vector<PointSighting>& sightings, double sigma_m) override;
  PoseEstimate pose() const override;
  bool landmark(int landmark, LandmarkEstimate& estimate) const override;
  int dimension() const override { return static_cast<int>(mean_.size()); }

 private:
  void initialise_jacobian(const Pose2& pose, const Eigen::Matrix3d& covariance);
  void initialise_moments(const Pose2& pose, const Eigen::Matrix3d& covariance);

  Noise noise_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
  SlotTable slots_;
};

}  // namespace cairn::host
