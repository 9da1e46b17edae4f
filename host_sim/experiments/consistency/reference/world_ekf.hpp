#pragma once

#include <vector>

#include "host_sim/experiments/consistency/filter.hpp"
#include "host_sim/experiments/consistency/reference/dense_kalman.hpp"

namespace cairn::host {

/// The extended Kalman filters that keep pose and map in world coordinates, state
/// (x, y, heading, p_1 .. p_n), and differ in where and how they linearise:
///
/// - kStandard: at the latest estimate (Smith, Self and Cheeseman 1990).
/// - kFirstEstimates: every Jacobian at the first estimate of what it concerns, so that the
///   unobservable directions keep dimension three (Huang, Mourikis and Roumeliotis 2010).
/// - kIterated: four Gauss-Newton passes over each update (Bell and Cathey 1993).
/// - kUnscented: statistical linearisation by sigma points over the marginal that a function really
///   depends on: (heading, forward, turn) for motion (27 Gauss-Hermite points), pose and landmark
///   (11 unscented points, kappa = 1) for an observation; the remainder of the spread enters as
///   noise. It is not a full-state unscented filter: the 2 (3 + 2n) + 1 points of that would ask
///   the same marginals, because all functions here are affine in the rest.
class WorldEkf final : public FilterUnderTest {
 public:
  enum class Kind { kStandard, kFirstEstimates, kIterated, kUnscented };

  explicit WorldEkf(Kind kind) : kind_(kind) {}

  void initialise(const Pose2& pose, const Eigen::Matrix3d& covariance) override;
  void predict(const Increment& step) override;
  void update(const std::vector<PointSighting>& sightings, double sigma_m) override;
  PoseEstimate pose() const override;
  bool landmark(int landmark, LandmarkEstimate& estimate) const override;
  int dimension() const override { return static_cast<int>(mean_.size()); }

 private:
  void predict_unscented(const Increment& step);
  void propagate(const Eigen::Matrix3d& f, const Eigen::Matrix3d& q);
  DenseRow linearise(const PointSighting& sighting, const Eigen::VectorXd& at,
                     double sigma_m) const;
  DenseRow linearise_unscented(const PointSighting& sighting, double sigma_m) const;
  void add_landmark(const PointSighting& sighting, double sigma_m);
  int column(int slot) const { return 3 + 2 * slot; }

  Kind kind_;
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
  SlotTable slots_;
  Eigen::Vector3d predicted_pose_ = Eigen::Vector3d::Zero();  ///< before the latest update
  std::vector<Eigen::Vector2d> first_estimates_;
};

}  // namespace cairn::host
