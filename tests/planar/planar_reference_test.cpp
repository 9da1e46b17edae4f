#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

#include "dense_reference.hpp"

namespace cairn {
namespace {

using planar_test::DenseEkf;
using planar_test::DenseRightInvariantEkf;
using planar_test::Drive;
using planar_test::feed;
using planar_test::make_drive;
using planar_test::start;
using planar_test::Step;
using planar_test::WorldSettings;

template <class Matrix>
double largest(const Matrix& m) {
  return m.cwiseAbs().maxCoeff();
}

class PlanarReference : public ::testing::TestWithParam<IncrementModel> {
 protected:
  Drive drive() const {
    WorldSettings s;
    s.model = GetParam();
    s.heading_variance = 0.03;
    return make_drive(7, s);
  }
};

TEST_P(PlanarReference, EkfEqualsDenseBatchEkf) {
  const Drive d = drive();
  EkfSlam<double, 20> filter;
  DenseEkf reference(d);
  ASSERT_TRUE(ok(start(filter, d, planar_test::ungated<double>())));
  for (const Step& step : d.steps) {
    feed(filter, d, step);
    reference.feed(step);
    const auto pose = filter.pose();
    ASSERT_LT(largest(pose.position - reference.pose().head<2>()), 1e-8);
    ASSERT_LT(std::abs(planar_test::wrapped(pose.heading - reference.pose()(2))), 1e-8);
    ASSERT_LT(largest(filter.pose_covariance() - reference.covariance()),
              1e-8 * largest(reference.covariance()));
  }
}

TEST_P(PlanarReference, GroupEqualsDenseRightInvariantEkf) {
  const Drive d = drive();
  GroupIekfSlam<double, 20> filter;
  DenseRightInvariantEkf reference(d);
  ASSERT_TRUE(ok(start(filter, d, planar_test::ungated<double>())));
  for (const Step& step : d.steps) {
    feed(filter, d, step);
    reference.feed(step);
    const auto pose = filter.mean_pose();
    ASSERT_LT(largest(pose.position - reference.position()), 1e-8);
    ASSERT_LT(std::abs(planar_test::wrapped(pose.heading - reference.heading())), 1e-8);
    // Undo the moments: heading variance and Cov(x, heading) determine the rest.
    const Eigen::Matrix3d c = filter.pose_covariance();
    const Eigen::Matrix3d r = reference.covariance();
    const double rho = std::exp(-0.5 * r(0, 0));
    const Eigen::Vector2d jx = planar_test::kJ * reference.relative_position();
    const Eigen::Vector2d xh = reference.relative_position();
    const Eigen::Vector2d cross = r.block<2, 1>(1, 0);
    const double vc = 0.5 * (1 + std::pow(rho, 4)) - rho * rho;
    const double vs = 0.5 * (1 - std::pow(rho, 4));
    Eigen::Matrix3d expected;
    expected.topLeftCorner<2, 2>() = vc * xh * xh.transpose() + vs * jx * jx.transpose() +
                                     rho * (jx * cross.transpose() + cross * jx.transpose()) +
                                     r.block<2, 2>(1, 1);
    expected.block<2, 1>(0, 2) = rho * r(0, 0) * jx + cross;
    expected.block<1, 2>(2, 0) = expected.block<2, 1>(0, 2).transpose();
    expected(2, 2) = r(0, 0);
    ASSERT_LT(largest(c - expected), 1e-8 * largest(expected));
  }
  for (int slot = 0; slot < filter.landmark_count(); ++slot) {
    EXPECT_LT(largest(filter.mean_landmark(slot) - reference.landmark(filter.landmark_id(slot))),
              1e-8);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, PlanarReference,
                         ::testing::Values(IncrementModel::kEuler, IncrementModel::kExactArc));

/// Noise gathered in 3x3 over many odometry steps is the noise added step by step to all states.
TEST(GroupIekfSlam, LazyNoiseEqualsStepwiseNoise) {
  for (const IncrementModel model : {IncrementModel::kEuler, IncrementModel::kExactArc}) {
    WorldSettings s;
    s.model = model;
    const Drive d = make_drive(5, s);
    GroupIekfSlam<double, 20> filter;
    DenseRightInvariantEkf reference(d);
    ASSERT_TRUE(ok(start(filter, d, planar_test::ungated<double>())));
    for (int k = 0; k < 100; ++k) {
      feed(filter, d, d.steps[k]);
      reference.feed(d.steps[k]);
    }
    const int n = filter.state_size();
    const auto difference = [&] {
      double worst = 0;
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          worst = std::max(
              worst, std::abs(filter.error_covariance(i, j) - reference.full_covariance()(i, j)));
        }
      }
      return worst;
    };
    const double before = difference();
    for (int k = 100; k < 400; ++k) {
      Step blind = d.steps[k];
      blind.update = false;
      feed(filter, d, blind);
      reference.feed(blind);
    }
    EXPECT_LT(difference() - before, 1e-12 * largest(reference.full_covariance()));
  }
}

TEST(GroupIekfSlam, FloatStaysWithinAMillimetreOfDouble) {
  const Drive d = make_drive(11);
  GroupIekfSlam<double, 20> exact;
  GroupIekfSlam<float, 20> single;
  ASSERT_TRUE(ok(start(exact, d)));
  ASSERT_TRUE(ok(start(single, d)));
  double worst = 0;
  for (const Step& step : d.steps) {
    feed(exact, d, step);
    feed(single, d, step);
    worst = std::max(
        worst, (exact.mean_pose().position - single.mean_pose().position.cast<double>()).norm());
  }
  EXPECT_LT(worst, 1e-3);
  RecordProperty("worst_um", static_cast<int>(1e6 * worst));
}

}  // namespace
}  // namespace cairn
