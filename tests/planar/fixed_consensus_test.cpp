// The 1-point consensus without floating point beside that in double.
#include <gtest/gtest.h>

#include "fixed_camera_drive.hpp"

namespace cairn {
namespace {

using Drive = planar_test::FixedCameraDrive<20>;

struct Sums {
  int frames = 0;
  int used = 0;
  int outliers = 0;
  int rescued = 0;
  int without_consensus = 0;
  int most_hypotheses = 0;
};

void drive_with_outliers(Drive& drive, int steps, double outliers, Sums& sums) {
  for (int k = 0; k < steps; ++k) {
    drive.move();
    drive.take_motion_in();
    const int before = drive.hypotheses();
    ASSERT_TRUE(drive.agree(outliers)) << k;
    ASSERT_TRUE(drive.good()) << k;
    ASSERT_LT(drive.mean_difference(), 1e-4) << k;
    ASSERT_LT(drive.covariance_difference(), 1e-4) << k;
    sums.most_hypotheses = std::max(sums.most_hypotheses, drive.hypotheses() - before);
    if (k % 9 == 8) drive.forget(static_cast<LandmarkId>(1 + k % Drive::kWorld));
  }
  sums.frames += steps;
  sums.used += drive.used();
  sums.outliers += drive.outliers();
  sums.rescued += drive.rescued();
  sums.without_consensus += drive.without_consensus();
  EXPECT_EQ(drive.fixed().saturations(), 0U);
}

/// `gate`: of the candidates; 1e9 lets all outliers through to the consensus.
void compare_drives(double gate, bool tilts) {
  Sums sums;
  for (const double outliers : {0.1, 0.2, 0.3, 0.4}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << "outliers " << outliers << ", seed " << seed);
      Drive drive(seed, tilts, 0.0, gate);
      drive_with_outliers(drive, 60, outliers, sums);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  EXPECT_GT(sums.used, 2 * sums.frames);
  EXPECT_GT(sums.outliers, sums.frames);
  EXPECT_GT(sums.rescued, 10);
  EXPECT_LT(sums.without_consensus, sums.frames);
  EXPECT_LE(sums.most_hypotheses, FixedRansacParameters{}.max_hypotheses);
  EXPECT_GT(sums.most_hypotheses, 3);
}

TEST(FixedConsensus, UsesWhatDoubleUsesOfOutliersAnywhere) {
  compare_drives(1e9, false);
}

TEST(FixedConsensus, UsesWhatDoubleUsesBehindAGate) {
  compare_drives(18.42, false);
}

TEST(FixedConsensus, UsesWhatDoubleUsesOnABodyThatTilts) {
  compare_drives(1e9, true);
}

/// With the odometry's noise taken in at its own place, where means differ in second order.
TEST(FixedConsensus, UsesWhatTheFilterInDoubleUsesAsItIs) {
  Drive drive(1, true, 0.0, 18.42);
  int same = 0;
  constexpr int kSteps = 60;
  for (int k = 0; k < kSteps; ++k) {
    drive.move();
    if (drive.agree(0.2)) ++same;
  }
  EXPECT_GE(same, kSteps - 1);
  EXPECT_LT(drive.mean_difference(), 2e-3);
}

TEST(FixedConsensus, RestsWhereDoubleRests) {
  Drive drive(5, true, 4.0, 18.42);
  for (int k = 0; k < 120; ++k) {
    const bool rests = k % 40 > 20;
    drive.move(rests ? 0.0 : 0.1, rests ? 0.0 : 0.02);
    ASSERT_TRUE(drive.agree(0.0)) << k;
    ASSERT_TRUE(drive.good()) << k;
  }
}

TEST(FixedConsensus, LeavesTheMeanWhereMatchesDisagree) {
  Drive drive(8, false);
  for (int k = 0; k < 20; ++k) {
    drive.move();
    drive.agree(0.0);
  }
  auto& filter = drive.fixed();
  const std::uint32_t missing = filter.health().ransac_no_consensus;
  FixedRansacParameters all;
  all.min_inlier_share = FixedRatio::nearest(1.0);
  ASSERT_EQ(filter.set_ransac(all), Status::kOk);
  const FixedPose before = filter.mean_pose();
  FixedPixelMatch matches[8];
  for (int k = 0; k < 8; ++k) {
    matches[k].id = filter.landmark_id(k);
    matches[k].pixel[0] = FixedPixel::nearest(40.0 * k);
    matches[k].pixel[1] = FixedPixel::nearest(37.0 * (k % 5));
    matches[k].inlier = true;
  }
  Random random(1);
  FixedUpdateReport report;
  EXPECT_EQ(filter.update_pixels(drive.camera(), drive.mount(), FixedPixel::nearest(0.5), matches,
                                 8, random, report),
            Status::kNoConsensus);
  EXPECT_EQ(report.nis_dof, 0);
  for (const FixedPixelMatch& match : matches) EXPECT_FALSE(match.inlier);
  EXPECT_EQ(filter.health().ransac_no_consensus, missing + 1);
  EXPECT_EQ(filter.mean_pose().x, before.x);
  EXPECT_EQ(filter.mean_pose().y, before.y);
  EXPECT_EQ(filter.mean_pose().heading, before.heading);
}

TEST(FixedConsensus, CountsHypothesesAndInliersAsInFloat) {
  const FixedRansacParameters fixed;
  const OnePointRansacParameters single = PlanarParameters<float>{}.ransac;
  ASSERT_EQ(fixed.max_hypotheses, single.max_hypotheses);
  for (int count = 1; count <= 64; ++count) {
    for (int inliers = 0; inliers <= count; ++inliers) {
      EXPECT_EQ(is_consensus(inliers, count, fixed), is_consensus(inliers, count, single))
          << inliers << " of " << count;
      for (const int limit : {1, 3, 16}) {
        EXPECT_EQ(hypotheses_needed(fixed, inliers, count, limit),
                  hypotheses_needed(single, inliers, count, limit))
            << inliers << " of " << count;
      }
    }
  }
}

TEST(FixedConsensus, RefusesParametersOutsideTheirDomain) {
  FixedGroupSlam<4, 3> filter;
  FixedPlanarParameters parameters;
  parameters.rescue_gate = FixedScore();
  EXPECT_EQ(filter.initialise({}, {}, parameters), Status::kBadConfig);
  parameters = {};
  parameters.ransac.probability = FixedRatio::nearest(1.0);
  EXPECT_EQ(filter.initialise({}, {}, parameters), Status::kBadConfig);
  ASSERT_EQ(filter.initialise({}, {}), Status::kOk);
  EXPECT_EQ(filter.set_ransac(parameters.ransac), Status::kInvalidArgument);
}

}  // namespace
}  // namespace cairn
