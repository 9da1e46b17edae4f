#include <memory>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

#include "covariance_drive.hpp"

namespace cairn {
namespace {

using planar_test::CameraDrive;
using planar_test::smallest_correlation_eigenvalue;

constexpr double kSound = -1e-5;  ///< least eigenvalue of a correlation matrix that passes
constexpr int kFramesPerMinute = 1800;

template <class Filter>
class Covariance : public ::testing::Test {};
using Filters = ::testing::Types<GroupIekfSlam<float, 32, 3>, EkfSlam<float, 32, 3>>;
TYPED_TEST_SUITE(Covariance, Filters, );

/// Each picture of a standing vehicle counted as new: what is measured for ever sinks below what
/// float resolves beside what is never measured.
TYPED_TEST(Covariance, StaysSoundInAMillionUpdatesOfOnePlace) {
  auto filter = std::make_unique<TypeParam>();
  PlanarParameters<float> parameters;
  parameters.rest_sigmas = 0.0F;
  CameraDrive<TypeParam> drive(*filter, 5, 1, parameters);
  for (int k = 0; k < 1000000; ++k) {
    drive.frame(0.0, 0.5);
    if (k % 20000 == 0) {
      ASSERT_GT(smallest_correlation_eigenvalue(*filter), kSound) << k;
    }
  }
  ASSERT_TRUE(drive.good());
  EXPECT_EQ(filter->health().covariance_repairs, 0U);
  EXPECT_EQ(filter->health().resets, 0U);
}

TYPED_TEST(Covariance, StandsForAnHourWhereItStopped) {
  auto filter = std::make_unique<TypeParam>();
  CameraDrive<TypeParam> drive(*filter, 24, 2);
  for (int k = 0; k < 60; ++k) drive.frame(0.005, 0.5);
  const auto stopped = filter->mean_pose();
  const double before = drive.position_error();
  for (int k = 0; k < 60 * kFramesPerMinute; ++k) {
    drive.frame(0.0, 0.5);
    ASSERT_TRUE(ok(drive.status()));
    if (k % kFramesPerMinute == 0) {
      ASSERT_GT(smallest_correlation_eigenvalue(*filter), kSound) << k;
    }
  }
  EXPECT_LT((filter->mean_pose().position - stopped.position).norm(), 0.05F);
  EXPECT_EQ(filter->health().covariance_repairs, 0U);
  EXPECT_EQ(filter->health().resets, 0U);
  // It drives on as if nothing had been.
  for (int k = 0; k < 30; ++k) drive.frame(0.005, 0.5);
  EXPECT_LT(drive.position_error(), before + 0.05);
}

/// Without motion and without news the state is equal to the bit.
TYPED_TEST(Covariance, APictureThatTellsNothingNewChangesNothing) {
  auto filter = std::make_unique<TypeParam>();
  CameraDrive<TypeParam> drive(*filter, 24, 3);
  for (int k = 0; k < 30; ++k) drive.frame(0.005, 0.5);
  const auto hash = [&filter] {
    Hash64 h;
    filter->hash(h);
    return h.value();
  };
  const std::uint64_t before = hash();
  for (int k = 0; k < 20; ++k) {
    drive.frame(0.0, 0.4);
    EXPECT_GT(drive.report().low_innovation, 10);
    EXPECT_EQ(hash(), before) << k;
  }
}

/// A vehicle that is pushed while its wheels stand: the sightings win.
TYPED_TEST(Covariance, FollowsAPushAtRest) {
  auto filter = std::make_unique<TypeParam>();
  CameraDrive<TypeParam> drive(*filter, 24, 4);
  for (int k = 0; k < 60; ++k) drive.frame(0.005, 0.5);
  const double before = drive.position_error();
  for (int k = 0; k < 30; ++k) drive.frame(0.004, 0.0, 0.5);
  for (int k = 0; k < 30; ++k) drive.frame(0.0, 0.5);
  EXPECT_LT(drive.position_error(), before + 0.04);
}

/// Pixels far better than the arithmetic, and then plausible ones: whatever had to be done to the
/// covariance was counted, and the filter works.
TYPED_TEST(Covariance, SurvivesPixelsOfImpossiblePrecision) {
  for (const double claimed : {1e-2, 1e-3, 1e-5}) {
    auto filter = std::make_unique<TypeParam>();
    CameraDrive<TypeParam> drive(*filter, 24, 5);
    for (int k = 0; k < 200; ++k) {
      drive.frame(0.005, 0.5);
      drive.see(0.0, claimed);
      ASSERT_GT(smallest_correlation_eigenvalue(*filter), -1.0) << claimed << ' ' << k;
    }
    for (int k = 0; k < 60; ++k) drive.frame(0.0, 0.5);
    EXPECT_GT(smallest_correlation_eigenvalue(*filter), kSound) << claimed;
    EXPECT_TRUE(ok(drive.status())) << claimed;
  }
}

/// Any sequence of motions, rests, good, bad and missing pictures keeps a sound covariance.
TYPED_TEST(Covariance, HoldsForRandomSequences) {
  const bool holds = rc::check([] {
    auto filter = std::make_unique<TypeParam>();
    const auto seed = *rc::gen::inRange<unsigned>(0, 100000);
    const int landmarks = *rc::gen::inRange(3, 24);
    CameraDrive<TypeParam> drive(*filter, landmarks, seed);
    const auto steps = *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 8));
    for (const int step : steps) {
      for (int k = 0; k < 20; ++k) {
        switch (step) {
          case 0:
            drive.frame(0.01, 0.5);
            break;
          case 1:
            drive.frame(0.0, 0.5);
            break;
          case 2:
            drive.frame(-0.01, 0.1);
            break;
          case 3:
            drive.frame(0.0, 0.01, 0.5);
            break;
          case 4:
            drive.see(0.5, 0.5);
            break;
          case 5:
            drive.see(k % 5 == 0 ? 100.0 : 0.5, 0.5);
            break;
          case 6:
            RC_ASSERT(ok(filter->widen_pose(1e-4F, 1e-6F)));
            break;
          default:
            if (filter->landmark_count() > 3) RC_ASSERT(ok(filter->remove_landmark(0)));
            drive.frame(0.005, 2.0);
        }
      }
      const double smallest = smallest_correlation_eigenvalue(*filter);
      RC_ASSERT(smallest > kSound);
    }
    RC_ASSERT(filter->health().resets == 0U);
  });
  EXPECT_TRUE(holds);
}

}  // namespace
}  // namespace cairn
