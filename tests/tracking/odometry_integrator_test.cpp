#include "cairn/tracking/odometry_integrator.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"

#include "odometry_fixture.hpp"

namespace cairn {
namespace {

TEST_F(AVehicleWithOdometry, MovesAsTheReadingsSay) {
  for (int k = 1; k <= 10; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 0.5F)));
  EXPECT_NEAR(x(), 0.5F, 1e-5F);
  EXPECT_FLOAT_EQ(odometry_.speed_mps(), 0.5F);
}

/// A circle is driven as one: what a step leaves out to the side, a camera would take for a turn.
TEST_F(AVehicleWithOdometry, FollowsTheArcOfASteadyTurn) {
  constexpr float kSpeed_mps = 2.0F;
  constexpr float kRate = 0.5F;
  const float radius_m = kSpeed_mps / kRate;
  ASSERT_TRUE(ok(add(1, kSpeed_mps, kRate)));
  for (int k = 1; k <= 30; ++k) {
    ASSERT_TRUE(ok(integrate_to(k * kPeriodUs - kPeriodUs / 3)));
    ASSERT_TRUE(ok(add(k * kPeriodUs, kSpeed_mps, kRate)));
    const float turned = 0.1F * kRate * static_cast<float>(k);
    const PlanarPose<float> pose = filter_.mean_pose();
    EXPECT_NEAR(pose.position.x(), radius_m * std::sin(turned), 1e-4F) << k;
    EXPECT_NEAR(pose.position.y(), radius_m * (1.0F - std::cos(turned)), 1e-4F) << k;
  }
}

TEST_F(AVehicleWithOdometry, MovesSinceTheStartAsTheFirstSampleSays) {
  ASSERT_TRUE(ok(integrate_to(kPeriodUs / 2)));
  ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
  EXPECT_NEAR(x(), 0.1F, 1e-5F);
}

TEST_F(AVehicleWithOdometry, HoldsTheLastMotionWithTheSameNoiseInAnyNumberOfSteps) {
  ASSERT_TRUE(ok(add(kPeriodUs, 0.5F)));
  Filter in_one = filter_;
  OdometryIntegrator same = odometry_;
  ASSERT_TRUE(ok(same.integrate_to(2 * kPeriodUs, in_one, health_)));
  for (int k = 1; k <= 10; ++k) ASSERT_TRUE(ok(integrate_to(kPeriodUs + k * kPeriodUs / 10)));
  EXPECT_NEAR(x(), in_one.mean_pose().position.x(), 1e-6F);
  const Matrix3<float> covariance = filter_.pose_covariance();
  const Matrix3<float> expected = in_one.pose_covariance();
  EXPECT_NEAR(covariance(0, 0) / expected(0, 0), 1.0F, 1e-4F);
  EXPECT_NEAR(covariance(2, 2) / expected(2, 2), 1.0F, 1e-4F);
  EXPECT_NEAR(odometry_.yaw_variance() / same.yaw_variance(), 1.0F, 1e-4F);
  odometry_.forget_yaw();
  EXPECT_EQ(odometry_.yaw_variance(), 0.0F);
}

/// Frames at 10 Hz, samples at 16 Hz, in a turn whose speed changes: what was extrapolated for a
/// frame must not stay in the pose.
TEST_F(AVehicleWithOdometry, CorrectsWhatWasHeldForAFrame) {
  Filter samples_only = filter_;
  OdometryIntegrator exact = odometry_;
  std::int64_t frame_us = 30000;
  for (int k = 1; k <= 160; ++k) {
    OdometrySample sample;
    sample.t_us = k * 62500;
    sample.speed_mps = 1.0F + 0.2F * static_cast<float>(k % 7);
    sample.turn = 0.1F * static_cast<float>(k % 5);
    for (; frame_us < sample.t_us; frame_us += kPeriodUs) ASSERT_TRUE(ok(integrate_to(frame_us)));
    ASSERT_TRUE(ok(odometry_.add(sample, filter_, health_)));
    ASSERT_TRUE(ok(exact.add(sample, samples_only, health_)));
  }
  const PlanarPose<float> expected = samples_only.mean_pose();
  EXPECT_NEAR(filter_.mean_pose().heading, expected.heading, 1e-5F);
  EXPECT_LT((filter_.mean_pose().position - expected.position).norm(), 0.02F);  // of 16 m
}

TEST_F(AVehicleWithOdometry, TakesALateSampleForTheTimeSinceTheOneBefore) {
  ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
  const float at_sample = x();
  ASSERT_TRUE(ok(integrate_to(kPeriodUs + 50000)));
  EXPECT_NEAR(x() - at_sample, 0.05F, 1e-5F);
  ASSERT_TRUE(ok(add(kPeriodUs + 40000, 2.0F)));
  EXPECT_NEAR(x() - at_sample, 0.10F, 1e-5F);
  ASSERT_TRUE(ok(integrate_to(kPeriodUs + 60000)));
  EXPECT_NEAR(x() - at_sample, 0.12F, 1e-5F);
}

TEST_F(AVehicleWithOdometry, RefusesWhatIsNoReading) {
  ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
  const float before = x();
  EXPECT_EQ(add(kPeriodUs, 1.0F), Status::kOk);  // the same time again: nothing to integrate
  EXPECT_EQ(add(kPeriodUs / 2, 1.0F), Status::kTimeBackwards);
  EXPECT_EQ(add(2 * kPeriodUs, std::numeric_limits<float>::quiet_NaN()), Status::kNonFiniteInput);
  EXPECT_EQ(add(2 * kPeriodUs, 1.0F, std::numeric_limits<float>::infinity()),
            Status::kNonFiniteInput);
  EXPECT_EQ(x(), before);
  EXPECT_EQ(health_.time_errors, 1U);
  EXPECT_EQ(health_.non_finite_inputs, 2U);
}

TEST_F(AVehicleWithOdometry, RefusesWhatNoVehicleDoesAndKeepsTheState) {
  ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
  OdometrySample steered;
  steered.t_us = 2 * kPeriodUs;
  steered.kind = OdometrySample::Kind::kAckermann;
  steered.speed_mps = 1.0F;
  steered.turn = 1.6F;
  EXPECT_EQ(odometry_.add(steered, filter_, health_), Status::kInvalidArgument);
  EXPECT_EQ(add(2 * kPeriodUs, 1e6F), Status::kInvalidArgument);
  EXPECT_EQ(add(2 * kPeriodUs, 1e38F), Status::kInvalidArgument);
  EXPECT_EQ(add(2 * kPeriodUs, 1.0F, 200.0F), Status::kInvalidArgument);
  OdometrySample of_no_kind;
  of_no_kind.t_us = 2 * kPeriodUs;
  of_no_kind.kind = static_cast<OdometrySample::Kind>(OdometrySample::kKindCount);
  EXPECT_EQ(odometry_.add(of_no_kind, filter_, health_), Status::kInvalidArgument);
  EXPECT_EQ(health_.odometry_refused, 5U);
  ASSERT_TRUE(ok(add(2 * kPeriodUs, 1.0F)));
  EXPECT_NEAR(x(), 0.2F, 1e-5F);
  EXPECT_EQ(filter_.mean_pose().heading, 0.0F);
}

TEST_F(AVehicleWithOdometry, HoldsTheMotionOverAGlitch) {
  for (int k = 1; k <= 10; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 0.5F)));
  const float variance = filter_.pose_covariance()(0, 0);
  EXPECT_EQ(add(11 * kPeriodUs, 50.0F), Status::kGated);
  EXPECT_NEAR(x(), 0.55F, 1e-4F);
  EXPECT_GT(filter_.pose_covariance()(0, 0) - variance, square(0.9F * 0.1F));
  ASSERT_TRUE(ok(add(12 * kPeriodUs, 0.5F)));
  EXPECT_NEAR(x(), 0.6F, 1e-4F);
  EXPECT_EQ(health_.odometry_glitches, 1U);
}

TEST_F(AVehicleWithOdometry, BelievesAJumpOfTheSpeedThatStays) {
  for (int k = 1; k <= 10; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 0.5F)));
  EXPECT_EQ(add(11 * kPeriodUs, 9.0F), Status::kGated);
  EXPECT_EQ(add(12 * kPeriodUs, 9.1F), Status::kGated);
  EXPECT_EQ(add(13 * kPeriodUs, 8.9F), Status::kOk);
  EXPECT_FLOAT_EQ(odometry_.speed_mps(), 8.9F);
}

/// A wild reading that no other follows is wrong by the same in every step for which it is held.
TEST_F(AVehicleWithOdometry, HoldsAnOutlyingTurnLessCertainly) {
  for (int k = 1; k <= 20; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 1.0F)));
  ASSERT_TRUE(ok(add(21 * kPeriodUs, 1.0F, 3.0F)));
  for (int k = 1; k <= 6; ++k) ASSERT_TRUE(ok(integrate_to(21 * kPeriodUs + k * 33333)));
  const float error = filter_.mean_pose().heading;
  EXPECT_GT(error, 0.8F);
  EXPECT_LT(error / std::sqrt(filter_.pose_covariance()(2, 2)), 3.0F);
}

/// The mean follows the reading; the sigma of an outlier grows with its distance from the readings
/// before it.
TEST_F(AVehicleWithOdometry, WidensTheNoiseOfAnOutlier) {
  for (int k = 1; k <= 20; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 1.0F)));
  odometry_.forget_yaw();
  ASSERT_TRUE(ok(add(21 * kPeriodUs, 1.0F, 0.05F)));
  const float usual = odometry_.yaw_variance();
  odometry_.forget_yaw();
  ASSERT_TRUE(ok(add(22 * kPeriodUs, 1.0F, 2.0F)));
  EXPECT_GT(odometry_.yaw_variance(), 10.0F * usual);
  EXPECT_NEAR(filter_.mean_pose().heading, 0.205F, 1e-4F);
}

struct LastIncrement {
  PlanarIncrement<float> increment;
  Status predict(const PlanarIncrement<float>& next) {
    increment = next;
    return Status::kOk;
  }
  Status widen_pose(float, float) { return Status::kOk; }
  Status slip_laterally(float) { return Status::kOk; }
};

/// Steering couples the noise of an Ackermann vehicle's turn to that of its speed. GIVEN a straight
/// course, WHEN one reading says that it is steered, THEN the vehicle turns by the reading, but the
/// coupling is that of the course.
TEST_F(AVehicleWithOdometry, LinearisesNoiseAtSteadyReadings) {
  LastIncrement last;
  OdometrySample sample;
  sample.kind = OdometrySample::Kind::kAckermann;
  sample.speed_mps = 1.0F;
  for (int k = 1; k <= 21; ++k) {
    sample.t_us = k * kPeriodUs;
    sample.turn = k == 21 ? 0.09F : 0.0F;
    ASSERT_TRUE(ok(odometry_.add(sample, last, health_)));
  }
  const PlanarIncrement<float> at_reading = ackermann_increment(
      1.0F, 0.09F, 0.1F, noise_.wheelbase_m, noise_.sigma_speed_mps, noise_.sigma_turn);
  EXPECT_FLOAT_EQ(last.increment.turn_rad, at_reading.turn_rad);
  EXPECT_GT(last.increment.covariance(0, 1), 0.0F);
  EXPECT_LT(last.increment.covariance(0, 1), 0.3F * at_reading.covariance(0, 1));
}

/// Times of the input's own, at both ends of what a stamp can say.
TEST_F(AVehicleWithOdometry, TakesTimesThatLieAnyDistanceApart) {
  constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  odometry_.reset(noise_, 1000000, kFirst);
  ASSERT_TRUE(ok(add(kFirst, 1.0F)));
  EXPECT_TRUE(odometry_.known());
  for (const std::int64_t t_us : {std::int64_t{66666}, kLast}) {
    static_cast<void>(add(t_us, 1.0F));
    static_cast<void>(integrate_to(t_us));
    EXPECT_TRUE(filter_.mean_pose().position.allFinite()) << t_us;
    EXPECT_TRUE(filter_.pose_covariance().allFinite()) << t_us;
  }
}

/// From a clock that was not set to one that is.
TEST_F(AVehicleWithOdometry, GoesOnAfterAGapOfAnyLength) {
  constexpr std::int64_t kSecondUs = 1000000;
  for (const std::int64_t gap_s : {10, 3600, 86400, 31557600, 1764600000}) {
    SetUp();
    ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
    ASSERT_TRUE(ok(add(2 * kPeriodUs, 1.0F)));
    EXPECT_EQ(add(gap_s * kSecondUs, 1.0F), Status::kTimeGap) << gap_s;
    EXPECT_TRUE(ok(add(gap_s * kSecondUs + kPeriodUs, 1.0F))) << gap_s;
    EXPECT_TRUE(filter_.pose_covariance().allFinite()) << gap_s;
  }
}

/// Of a vehicle that turns by more than half a turn while nothing is heard of it.
TEST_F(AVehicleWithOdometry, GoesOnAfterAGapInAFastTurn) {
  for (const std::int64_t gap_us : {3500000, 4000000, 9000000}) {
    SetUp();
    ASSERT_TRUE(ok(add(kPeriodUs, 0.1F, 1.0F)));
    ASSERT_TRUE(ok(add(2 * kPeriodUs, 0.1F, 1.0F)));
    EXPECT_EQ(add(2 * kPeriodUs + gap_us, 0.1F, 1.0F), Status::kTimeGap) << gap_us;
    EXPECT_TRUE(ok(add(3 * kPeriodUs + gap_us, 0.1F, 1.0F))) << gap_us;
    EXPECT_GT(filter_.pose_covariance()(2, 2), 0.5F) << gap_us;
  }
}

}  // namespace
}  // namespace cairn
