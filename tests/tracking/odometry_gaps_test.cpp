// What OdometryIntegrator makes of times without samples.

#include <cmath>

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"

#include "odometry_fixture.hpp"

namespace cairn {
namespace {

TEST_F(AVehicleWithOdometry, IsAtRestBeforeTheFirstSampleButNotForEver) {
  ASSERT_TRUE(ok(integrate_to(10 * kPeriodUs)));
  EXPECT_EQ(integrate_to(20 * kPeriodUs), Status::kTimeGap);
  EXPECT_EQ(x(), 0.0F);
  EXPECT_NEAR(std::sqrt(filter_.pose_covariance()(0, 0)), 1.5F, 0.01F);
  EXPECT_EQ(health_.odometry_timeouts, 1U);
}

TEST_F(AVehicleWithOdometry, BecomesUncertainByWhatItCanHaveDoneInAGap) {
  ASSERT_TRUE(ok(add(kPeriodUs, 2.0F)));
  const float before = x();
  EXPECT_EQ(add(kPeriodUs + 4000000, 2.0F), Status::kTimeGap);
  EXPECT_NEAR(x() - before, 8.0F, 1e-3F);  // as the readings before and after it say
  const Matrix3<float> covariance = filter_.pose_covariance();
  EXPECT_GT(covariance(0, 0), square(2.0F * 3.0F));
  EXPECT_GT(covariance(2, 2), square(0.5F * 3.0F));
  ASSERT_TRUE(ok(add(2 * kPeriodUs + 4000000, 2.0F)));
  EXPECT_EQ(health_.odometry_timeouts, 1U);
}

/// One reading every 33 ms, then none for 0.8 s, in which the vehicle begins to turn. What the next
/// one says is the motion at its time, and no more of the time before than the last one said.
TEST_F(AVehicleWithOdometry, BridgesSamplesThatAreMissing) {
  constexpr std::int64_t kShortUs = 33333;
  for (int k = 1; k <= 30; ++k) ASSERT_TRUE(ok(add(k * kShortUs, 1.0F)));
  const float before = x();
  const Matrix3<float> known = filter_.pose_covariance();
  EXPECT_EQ(add(30 * kShortUs + 800000, 1.4F, 0.5F), Status::kOk);
  const float way_m = std::sqrt(square(x() - before) + square(filter_.mean_pose().position.y()));
  EXPECT_NEAR(way_m, 0.8F * 1.2F, 0.01F);
  EXPECT_NEAR(filter_.mean_pose().heading, 0.2F, 1e-3F);
  const Matrix3<float> added = filter_.pose_covariance() - known;
  EXPECT_GT(std::sqrt(added(2, 2)), 0.13F);  // a turn that began at once is 0.4 rad, 1.5 sigmas off
  EXPECT_LT(std::sqrt(added(2, 2)), 0.2F);
  EXPECT_GT(std::sqrt(added(0, 0)), 0.2F);
  EXPECT_LT(std::sqrt(added(0, 0)), 0.5F);
  EXPECT_EQ(health_.odometry_timeouts, 0U);
}

/// The clock believes a gap by a frame, which holds the motion for the longest step; the sample
/// after it says what the rest was.
TEST_F(AVehicleWithOdometry, BridgesAGapThatAFrameCameThrough) {
  constexpr std::int64_t kGapUs = 3000000;
  for (int k = 1; k <= 30; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 1.0F)));
  EXPECT_EQ(integrate_to(30 * kPeriodUs + kGapUs), Status::kTimeGap);
  EXPECT_NEAR(x(), 4.0F, 1e-3F);
  EXPECT_EQ(add(30 * kPeriodUs + kGapUs + 33333, 1.0F, 0.2F), Status::kTimeGap);
  const auto& position = filter_.mean_pose().position;
  EXPECT_NEAR(position.norm(), 6.0F, 0.1F);
  EXPECT_NEAR(filter_.mean_pose().heading, 0.3F, 0.02F) << "it turned for the second half";
  EXPECT_GT(std::sqrt(filter_.pose_covariance()(2, 2)), 1.0F) << "for all that is known";
}

/// The first reading after a gap is half of what is known of it: the next ones say which part of it
/// was noise, as long as no image has corrected the pose.
TEST_F(AVehicleWithOdometry, HearsMoreThanOneReadingOfWhatAGapWas) {
  constexpr std::int64_t kShortUs = 33333;
  constexpr float kNoise = 0.3F;
  for (const std::int64_t gap_us : {800000, 3000000}) {
    for (const bool seen : {false, true}) {
      SetUp();
      for (int k = 1; k <= 30; ++k) ASSERT_TRUE(ok(add(k * kShortUs, 1.0F, 0.1F)));
      const float before = filter_.mean_pose().heading;
      const std::int64_t end_us = 30 * kShortUs + gap_us;
      if (gap_us > 1000000) static_cast<void>(integrate_to(end_us));
      static_cast<void>(add(end_us, 1.0F, 0.1F + kNoise));
      const float at_once = filter_.mean_pose().heading - before;
      const float gap_s = 1e-6F * static_cast<float>(gap_us);
      EXPECT_NEAR(at_once, (0.1F + 0.5F * kNoise) * gap_s, 0.02F);
      if (seen) odometry_.note_image_update(0.0F, 0.0F, 0.033F, false);
      for (int k = 1; k <= 14; ++k) ASSERT_TRUE(ok(add(end_us + k * kShortUs, 1.0F, 0.1F)));
      const float noise_left = filter_.mean_pose().heading - before - 0.1F * (gap_s + 14 * 0.0333F);
      const float noise = 0.5F * kNoise * gap_s;
      if (seen) {
        EXPECT_NEAR(noise_left, noise, 0.02F);
      } else {
        EXPECT_LT(std::abs(noise_left), 0.3F * noise);
      }
    }
  }
}

TEST_F(AVehicleWithOdometry, BridgesNoGapThatAnImageCorrectedAndNoneOfAnHour) {
  for (int k = 1; k <= 30; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 1.0F)));
  EXPECT_EQ(integrate_to(33 * 1000000), Status::kTimeGap);
  EXPECT_EQ(add(33 * 1000000 + 33333, 1.0F), Status::kTimeGap);
  EXPECT_NEAR(x(), 4.0F, 0.1F);
  EXPECT_EQ(integrate_to(36 * 1000000), Status::kTimeGap);
  odometry_.note_image_update(0.0F, 0.0F, 3.0F, false);
  EXPECT_EQ(add(36 * 1000000 + 33333, 1.0F), Status::kTimeGap);
  EXPECT_NEAR(x(), 5.0F, 0.1F);
}

/// Slow odometry is no gap: each reading is the motion since the one before.
TEST_F(AVehicleWithOdometry, TakesSlowSamplesForTheTimeSinceTheOnesBefore) {
  for (int k = 1; k <= 30; ++k) ASSERT_TRUE(ok(add(k * 500000, 1.0F)));
  const Matrix3<float> known = filter_.pose_covariance();
  ASSERT_TRUE(ok(add(31 * 500000, 1.0F, 0.2F)));
  EXPECT_NEAR(filter_.mean_pose().heading, 0.1F, 1e-3F);
  EXPECT_LT(std::sqrt((filter_.pose_covariance() - known)(2, 2)), 0.03F);
}

/// What is held while samples stay away is what the readings say on average, not the last one's
/// noise.
TEST_F(AVehicleWithOdometry, HoldsItsUsualMotionWhileSamplesAreMissing) {
  for (int k = 1; k <= 30; ++k) {
    ASSERT_TRUE(ok(add(k * kPeriodUs, 1.0F, k % 2 == 0 ? 0.3F : -0.3F)));
  }
  const float heading = filter_.mean_pose().heading;
  for (int k = 1; k <= 24; ++k) ASSERT_TRUE(ok(integrate_to(30 * kPeriodUs + k * 33333)));
  EXPECT_NEAR(filter_.mean_pose().heading, heading, 0.16F);
}

TEST_F(AVehicleWithOdometry, SaysThatOdometryFellSilent) {
  ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
  const std::int64_t last = kPeriodUs + 1000000;
  for (std::int64_t t = 2 * kPeriodUs; t <= last; t += 33333) ASSERT_TRUE(ok(integrate_to(t)));
  EXPECT_EQ(health_.odometry_timeouts, 0U);
  for (int k = 1; k <= 600; ++k) EXPECT_EQ(integrate_to(last + k * kPeriodUs), Status::kTimeGap);
  EXPECT_NEAR(x(), 1.1F, 1e-3F);
  EXPECT_NEAR(std::sqrt(filter_.pose_covariance()(0, 0)), 60.0F, 3.0F);
  EXPECT_LT(filter_.pose_covariance()(2, 2), 3.5F);  // no more than not known at all
  EXPECT_EQ(health_.odometry_timeouts, 600U);
}

TEST_F(AVehicleWithOdometry, CountsFromTheFirstInputWhereverItsClockStands) {
  constexpr std::int64_t kEpochUs = 1700000000000000;
  ASSERT_TRUE(ok(add(kEpochUs, 1.0F)));
  EXPECT_EQ(x(), 0.0F);
  ASSERT_TRUE(ok(add(kEpochUs + kPeriodUs, 1.0F)));
  EXPECT_NEAR(x(), 0.1F, 1e-5F);
  const float before = filter_.pose_covariance()(0, 0);
  ASSERT_TRUE(ok(odometry_.restart_clock(-5, filter_)));
  EXPECT_NEAR(filter_.pose_covariance()(0, 0) - before, square(0.5F), 1e-3F);
  ASSERT_TRUE(ok(add(-5 + kPeriodUs, 1.0F)));
  EXPECT_NEAR(x(), 0.2F, 1e-5F);
}

}  // namespace
}  // namespace cairn
