#include <gtest/gtest.h>

#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

#include "reduced_lifted_reference.hpp"

namespace cairn {
namespace {

using planar_test::Drive;
using planar_test::feed;
using planar_test::make_drive;
using planar_test::ReducedLifted;
using planar_test::start;
using planar_test::Step;
using planar_test::WorldSettings;

struct Case {
  bool moments;
  IncrementModel model;
};

class LiftedFilter : public ::testing::TestWithParam<Case> {};

/// The full 11 + 6n filter and its quotient agree in pose and covariance over a whole run.
TEST_P(LiftedFilter, EqualsReducedFilter) {
  WorldSettings s;
  s.landmarks = 12;
  s.loops = GetParam().moments ? 1 : 2;
  s.model = GetParam().model;
  s.heading_variance = 0.03;
  const Drive d = make_drive(21, s);
  LiftedIekfSlam<double, 12> filter;
  ReducedLifted reference(d, GetParam().moments);
  LiftedParameters lifted;
  lifted.exact_moments = GetParam().moments;
  ASSERT_TRUE(ok(start(filter, d, planar_test::ungated<double>(), lifted)));
  double worst_pose = 0;
  double worst_covariance = 0;
  for (const Step& step : d.steps) {
    feed(filter, d, step);
    reference.feed(step);
    const auto pose = filter.pose();
    const Eigen::Vector3d p(pose.position.x(), pose.position.y(), pose.heading);
    Eigen::Vector3d e = p - reference.pose();
    e(2) = planar_test::wrapped(e(2));
    worst_pose = std::max(worst_pose, e.cwiseAbs().maxCoeff() / reference.pose().norm());
    const Eigen::Matrix3d c = reference.covariance();
    worst_covariance =
        std::max(worst_covariance,
                 (filter.pose_covariance() - c).cwiseAbs().maxCoeff() / c.cwiseAbs().maxCoeff());
  }
  EXPECT_LT(worst_pose, 1e-8);
  EXPECT_LT(worst_covariance, 1e-8);
}

INSTANTIATE_TEST_SUITE_P(Noise, LiftedFilter,
                         ::testing::Values(Case{false, IncrementModel::kEuler},
                                           Case{false, IncrementModel::kExactArc},
                                           Case{true, IncrementModel::kEuler},
                                           Case{true, IncrementModel::kExactArc}));

}  // namespace
}  // namespace cairn
