#include "cairn/tracking/odometry_integrator.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

namespace cairn {
namespace {

/// GIVEN a vehicle at the origin, whose odometry reports speed and yaw rate ten times a second.
class AVehicleWithOdometry : public ::testing::Test {
 protected:
  using Filter = GroupIekfSlam<float, 4, 3>;
  static constexpr std::int64_t kPeriodUs = 100000;

  void SetUp() override {
    EXPECT_TRUE(ok(filter_.initialise({}, 1e-8F * Matrix3<float>::Identity())));
    odometry_.reset(noise_, 1000000, 0);
  }
  Status add(std::int64_t t_us, float speed_mps, float yaw_rate = 0.0F) {
    OdometrySample sample;
    sample.t_us = t_us;
    sample.speed_mps = speed_mps;
    sample.turn = yaw_rate;
    return odometry_.add(sample, filter_, health_);
  }
  Status integrate_to(std::int64_t t_us) { return odometry_.integrate_to(t_us, filter_, health_); }
  float x() const { return filter_.mean_pose().position.x(); }

  OdometryNoise noise_;
  Filter filter_;
  OdometryIntegrator odometry_;
  Health health_;
};

TEST_F(AVehicleWithOdometry, MovesAsTheReadingsSay) {
  for (int k = 1; k <= 10; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 0.5F)));
  EXPECT_NEAR(x(), 0.5F, 1e-5F);
  EXPECT_FLOAT_EQ(odometry_.speed_mps(), 0.5F);
}

TEST_F(AVehicleWithOdometry, IsAtRestBeforeTheFirstSampleButNotForEver) {
  ASSERT_TRUE(ok(integrate_to(10 * kPeriodUs)));
  EXPECT_EQ(integrate_to(20 * kPeriodUs), Status::kTimeGap);
  EXPECT_EQ(x(), 0.0F);
  EXPECT_NEAR(std::sqrt(filter_.pose_covariance()(0, 0)), 1.5F, 0.01F);
  EXPECT_EQ(health_.odometry_timeouts, 1U);
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

TEST_F(AVehicleWithOdometry, LeavesAloneWhatAnImageHasCorrected) {
  ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
  ASSERT_TRUE(ok(integrate_to(kPeriodUs + 50000)));
  odometry_.note_image_update(0.0F, 0.0F, 0.1F, false);
  const float at_frame = x();
  ASSERT_TRUE(ok(add(kPeriodUs + 90000, 3.0F)));
  EXPECT_NEAR(x() - at_frame, 0.12F, 1e-5F);
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

TEST_F(AVehicleWithOdometry, TrustsWheelsLessThatAnImageShowsToSlip) {
  for (int k = 1; k <= 10; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 1.0F)));
  OdometryIntegrator gripping = odometry_;
  Filter other = filter_;
  odometry_.note_image_update(-0.1F, 0.0F, 0.1F, false);  // stood while the wheels said 1 m/s
  gripping.note_image_update(-0.01F, 0.0F, 0.1F, false);
  OdometrySample sample;
  sample.t_us = 11 * kPeriodUs;
  sample.speed_mps = 1.0F;
  const float before = other.pose_covariance()(0, 0);
  ASSERT_TRUE(ok(gripping.add(sample, other, health_)));
  ASSERT_TRUE(ok(odometry_.add(sample, filter_, health_)));
  EXPECT_NEAR(other.pose_covariance()(0, 0) - before, square(0.01F), 1e-5F);
  EXPECT_NEAR(filter_.pose_covariance()(0, 0) - before, square(0.1F), 1e-4F);
}

TEST_F(AVehicleWithOdometry, ForgetsASlipWithTimeAlsoWithoutAnImage) {
  for (int k = 1; k <= 10; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 1.0F)));
  odometry_.note_image_update(-0.1F, 0.0F, 0.1F, false);
  for (int k = 11; k <= 60; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 1.0F)));
  const float before = filter_.pose_covariance()(0, 0);
  ASSERT_TRUE(ok(add(61 * kPeriodUs, 1.0F)));
  EXPECT_NEAR(filter_.pose_covariance()(0, 0) - before, square(0.01F), 5e-5F);
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

/// A wild reading that no other follows is wrong by the same in every step for which it is held.
TEST_F(AVehicleWithOdometry, HoldsAnOutlyingTurnLessCertainly) {
  for (int k = 1; k <= 20; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 1.0F)));
  ASSERT_TRUE(ok(add(21 * kPeriodUs, 1.0F, 3.0F)));
  for (int k = 1; k <= 6; ++k) ASSERT_TRUE(ok(integrate_to(21 * kPeriodUs + k * 33333)));
  const float error = filter_.mean_pose().heading;
  EXPECT_GT(error, 0.8F);
  EXPECT_LT(error / std::sqrt(filter_.pose_covariance()(2, 2)), 3.0F);
}

/// Frames at 30 Hz whose images correct the pose to a drive at `true_mps`.
class ACameraBesideOdometry : public AVehicleWithOdometry {
 protected:
  static constexpr std::int64_t kFrameUs = 33333;
  static constexpr float kFrameS = 0.033333F;

  /// One frame, with a sample of `said_mps` before it where that is given.
  void frame(float true_mps, const float* said_mps, bool sure = true) {
    const float before = x();
    t_us_ += kFrameUs;
    if (said_mps != nullptr) last_ = add(t_us_, *said_mps);
    static_cast<void>(integrate_to(t_us_));
    odometry_.note_image_update(true_mps * kFrameS - (x() - before), 0.0F, kFrameS, sure);
  }
  void frames(int count, float true_mps, const float* said_mps, bool sure = true) {
    for (int k = 0; k < count; ++k) frame(true_mps, said_mps, sure);
  }

  void SetUp() override {
    AVehicleWithOdometry::SetUp();
    t_us_ = 0;
  }

  std::int64_t t_us_ = 0;
  Status last_ = Status::kOk;
};

/// GIVEN samples at 1 m/s that fall silent, WHEN the vehicle brakes to 0.5 m/s, THEN the speed held
/// is that of the images, and each further step is as uncertain as a step's acceleration.
TEST_F(ACameraBesideOdometry, HoldsTheSpeedOfTheImagesWhileSamplesAreSilent) {
  const float one = 1.0F;
  frames(30, 1.0F, &one);
  frames(60, 0.5F, nullptr);
  EXPECT_NEAR(odometry_.speed_mps(), 0.5F, 0.01F);
  EXPECT_FALSE(odometry_.known());
  EXPECT_FALSE(odometry_.contradicted());
  EXPECT_GT(health_.odometry_timeouts, 20U);
  const float variance = filter_.pose_covariance()(0, 0);
  frame(0.5F, nullptr);
  EXPECT_LT(filter_.pose_covariance()(0, 0) - variance, square(0.01F));
  frame(0.5F, &one);
  EXPECT_FLOAT_EQ(odometry_.speed_mps(), 1.0F);
}

TEST_F(ACameraBesideOdometry, ContradictsOdometryThatLies) {
  for (const float said : {0.0F, 3.6F, -1.0F, 2.2F, 0.5F}) {
    SetUp();
    const float one = 1.0F;
    frames(30, 1.0F, &one);
    EXPECT_FALSE(odometry_.contradicted());
    frames(30, 1.0F, &said);
    EXPECT_TRUE(odometry_.contradicted()) << said;
    EXPECT_EQ(last_, Status::kGated) << said;
    EXPECT_NEAR(odometry_.speed_mps(), 1.0F, 0.1F) << said;
    frames(30, 1.0F, &one);
    EXPECT_FALSE(odometry_.contradicted()) << said;
    EXPECT_FLOAT_EQ(odometry_.speed_mps(), 1.0F);
  }
}

/// Noise, a scale that is a tenth off, and images of few landmarks contradict nothing.
TEST_F(ACameraBesideOdometry, TakesNoiseForNoContradiction) {
  Random random(1);
  for (int k = 0; k < 3000; ++k) {
    float noise = 0.0F;  // of a frame, nearly Gaussian
    for (int i = 0; i < 12; ++i) noise += static_cast<float>(random.below(1000)) * 1e-3F;
    const float said = 1.1F + (noise - 6.0F) * noise_.sigma_speed_mps * sqrt(0.1F / kFrameS);
    frame(1.0F, &said);
    ASSERT_FALSE(odometry_.contradicted()) << k;
  }
  const float none = 0.0F;
  frames(60, 1.0F, &none, false);
  EXPECT_FALSE(odometry_.contradicted());
}

/// A scale that the map has and odometry has not for seconds: the samples are believed, and
/// doubted.
TEST_F(ACameraBesideOdometry, BelievesOdometryThatStays) {
  const float one = 1.0F;
  const float twice = 2.0F;
  frames(30, 1.0F, &one);
  frames(150, 1.0F, &twice);
  ASSERT_EQ(last_, Status::kGated);
  frames(200, 1.0F, &twice);
  EXPECT_EQ(last_, Status::kOk);
  EXPECT_FLOAT_EQ(odometry_.speed_mps(), 2.0F);
  EXPECT_TRUE(odometry_.contradicted());
  frames(320, 2.0F, &twice);
  EXPECT_FALSE(odometry_.contradicted());
}

/// Blind images contradict nothing: the samples are taken again, less certainly for a while.
TEST_F(ACameraBesideOdometry, BelievesOdometryAgainWhereImagesSeeNothing) {
  const float one = 1.0F;
  const float none = 0.0F;
  frames(30, 1.0F, &one);
  frames(30, 1.0F, &none);
  ASSERT_TRUE(odometry_.contradicted());
  for (int k = 0; k < 30; ++k) {
    t_us_ += kFrameUs;
    last_ = add(t_us_, 0.0F);
    static_cast<void>(integrate_to(t_us_));
  }
  EXPECT_FALSE(odometry_.contradicted());
  EXPECT_EQ(last_, Status::kOk);
  EXPECT_EQ(odometry_.speed_mps(), 0.0F);
}

TEST(OdometryNoiseParameters, AreCheckedWhole) {
  EXPECT_TRUE(ok(OdometryNoise{}.validate()));
  float OdometryNoise::*const members[] = {
      &OdometryNoise::sigma_speed_mps,       &OdometryNoise::sigma_turn,
      &OdometryNoise::wheelbase_m,           &OdometryNoise::sample_period_s,
      &OdometryNoise::max_acceleration_mps2, &OdometryNoise::unknown_speed_mps,
      &OdometryNoise::unknown_yaw_rate_radps};
  for (float OdometryNoise::*const member : members) {
    for (const float value : {0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(),
                              std::numeric_limits<float>::infinity()}) {
      OdometryNoise noise;
      noise.*member = value;
      EXPECT_EQ(noise.validate(), Status::kBadConfig);
    }
  }
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

}  // namespace
}  // namespace cairn
