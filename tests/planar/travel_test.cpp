#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

#include "tilting_drive.hpp"

// A vehicle that travels beside its x axis.

namespace cairn {
namespace {

using planar_test::Consistency;
using planar_test::drive;
using planar_test::Floor;
using planar_test::suspension;

constexpr double kSigma_rad = 0.02;
using Group = GroupIekfSlam<double, 40, 3>;
using Model = GroupErrorModel<double, 4, 3, 2, 1>;

/// A model that has travelled beside its axis and seen three landmarks on the way.
Model travelling_model(bool tilts) {
  Model model;
  PlanarPose<double> pose;
  pose.position = {1.0, -2.0};
  pose.heading = 0.7;
  model.start(pose, Vector3<double>(0.04, 0.09, 0.01).asDiagonal());
  if (tilts) model.start_tilt(suspension());
  model.start_travel(kSigma_rad);
  std::vector<double> d(Model::kStates, 0.0);
  d[model.travel_state()] = 0.03;
  model.correct(d.data());
  for (int i = 0; i < 3; ++i) {
    model.append_landmark({9.0 - i, 1.0 + i, 0.5}, Matrix3<double>::Identity() * 0.02);
    model.propagate(twist_increment(5.0, 0.4, 0.1, 0.0, 0.0, IncrementModel::kExactArc));
  }
  return model;
}

Eigen::MatrixXd covariance_of(const Model& model) {
  const int n = model.covariance().size();
  Eigen::MatrixXd P(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) P(i, j) = model.error_covariance(i, j);
  }
  return P;
}

class TravelModel : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(Bodies, TravelModel, ::testing::Bool());

/// F P F^T with the column of F by the direction of travel from differences.
TEST_P(TravelModel, TheCovarianceMovesAsTheDenseProductSays) {
  constexpr double kStep = 1e-6;
  const auto step = twist_increment(6.0, -0.5, 0.1, 0.0, 0.0, IncrementModel::kExactArc);
  const Model model = travelling_model(GetParam());
  const int travel = model.travel_state();
  Vector2<double> place[2];
  for (int side = 0; side < 2; ++side) {
    std::vector<double> d(Model::kStates, 0.0);
    d[travel] = side == 0 ? kStep : -kStep;
    Model moved = model;
    moved.correct(d.data());
    moved.propagate(step);
    place[side] = moved.mean_pose().position;
  }
  const Eigen::MatrixXd P = covariance_of(model);
  Eigen::MatrixXd F = Eigen::MatrixXd::Identity(P.rows(), P.cols());
  F.block<2, 1>(Model::kPositionState, travel) = (place[0] - place[1]) / (2.0 * kStep);
  Model moved = model;
  moved.propagate(step);
  EXPECT_LT((covariance_of(moved) - F * P * F.transpose()).cwiseAbs().maxCoeff(), 1e-9);
}

TEST_P(TravelModel, AVehicleTravelsBesideItsAxis) {
  Model model = travelling_model(GetParam());
  const PlanarPose<double> before = model.mean_pose();
  model.propagate(twist_increment(5.0, 0.0, 0.1, 0.0, 0.0, IncrementModel::kExactArc));
  const Vector2<double> way = model.mean_pose().position - before.position;
  EXPECT_NEAR(std::atan2(way.y(), way.x()) - before.heading, std::atan(0.03), 1e-9);
}

/// What is unsure of the direction is unsure of the place, not of what was seen beside it.
TEST_P(TravelModel, AnErrorOfTheDirectionIsOneOfThePlace) {
  Model model;
  model.start({}, Matrix3<double>::Zero());
  if (GetParam()) model.start_tilt(suspension());
  model.start_travel(kSigma_rad);
  model.append_landmark({9.0, 1.0, 0.5}, Matrix3<double>::Identity() * 1e-6);
  for (int i = 0; i < 10; ++i) model.propagate(twist_increment(5.0, 0.0, 0.1, 0.0, 0.0));
  EXPECT_NEAR(model.pose_covariance()(1, 1), square(5.0 * kSigma_rad), 1e-9);
  EXPECT_NEAR(model.pose_covariance()(0, 0), 0.0, 1e-9);
  EXPECT_EQ(model.travel().variance, square(kSigma_rad));
}

TEST(Travel, RefusesASigmaThatIsNone) {
  Group filter;
  PlanarParameters<double> parameters;
  for (const double sigma : {-0.01, 0.31, static_cast<double>(NAN)}) {
    parameters.travel_sigma_rad = sigma;
    EXPECT_EQ(filter.initialise({}, Matrix3<double>::Zero(), parameters), Status::kBadConfig);
  }
}

/// Filters without the state travel along the axis, whatever they are told.
TEST(Travel, SmallMapsAndOtherFiltersLeaveItOut) {
  PlanarParameters<double> parameters;
  parameters.travel_sigma_rad = kSigma_rad;
  GroupIekfSlam<double, 16, 3> small;
  EkfSlam<double, 40, 3> ekf;
  ASSERT_TRUE(ok(small.initialise({}, Matrix3<double>::Identity(), parameters)));
  ASSERT_TRUE(ok(ekf.initialise({}, Matrix3<double>::Identity(), parameters)));
  EXPECT_EQ(small.travel().variance, 0.0);
  EXPECT_EQ(small.state_size(), 3);
  EXPECT_EQ(ekf.state_size(), 3);
}

/// Errors of one drive go together: 40 drives bound the mean NEES to about a seventh of itself,
/// that of the direction, once a drive, to a quarter.
TEST(TravelDrive, PoseAndDirectionAreAsUncertainAsTheySay) {
  const Consistency told =
      drive<Group>(40, {suspension(), 1.0, Floor::kFollows, kSigma_rad, kSigma_rad});
  ::testing::Test::RecordProperty("pose_nees_permille", static_cast<int>(1e3 * told.pose));
  ::testing::Test::RecordProperty("travel_nees_permille", static_cast<int>(1e3 * told.travel));
  EXPECT_NEAR(told.pose, 3.0, 1.2);
  EXPECT_NEAR(told.travel, 1.0, 0.5);
  EXPECT_NEAR(told.nis, 1.0, 0.05);
  EXPECT_GT(told.inlier_share, 0.97);
}

/// A filter that takes the axis for the direction turns its map.
TEST(TravelDrive, TheStateHalvesTheErrorOfTheHeading) {
  const Consistency along = drive<Group>(20, {suspension(), 1.0, Floor::kFollows, 0.0, kSigma_rad});
  const Consistency told =
      drive<Group>(20, {suspension(), 1.0, Floor::kFollows, kSigma_rad, kSigma_rad});
  EXPECT_LT(told.heading_rad, 0.5 * along.heading_rad);
}

/// Where the axis is the direction, little is lost by not being sure of it.
TEST(TravelDrive, AVehicleAlongItsAxisLosesLittle) {
  const Consistency along = drive<Group>(20, {suspension()});
  const Consistency unsure = drive<Group>(20, {suspension(), 1.0, Floor::kFollows, 0.0035, 0.0});
  EXPECT_LT(unsure.heading_rad, 1.2 * along.heading_rad);
}

}  // namespace
}  // namespace cairn
