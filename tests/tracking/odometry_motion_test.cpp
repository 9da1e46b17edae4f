#include "cairn/tracking/odometry_motion.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

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

TEST(OdometryNoiseParameters, MayHaveNoLateralSlip) {
  OdometryNoise noise;
  noise.turn_centre_m = 0.0F;
  EXPECT_TRUE(ok(noise.validate()));
  for (const float value : {-0.1F, 11.0F, std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity()}) {
    noise.turn_centre_m = value;
    EXPECT_EQ(noise.validate(), Status::kBadConfig);
  }
}

/// GIVEN readings of 1 m/s straight ahead, ten a second from time 0 on.
class AHeldMotion : public ::testing::Test {
 protected:
  static constexpr std::int64_t kPeriodUs = 100000;

  void SetUp() override {
    motion_.reset(noise_, 1000000, 0);
    for (int k = 1; k <= 20; ++k) motion_.take(reading(k, 1.0F));
  }
  static OdometrySample reading(int period, float speed_mps, float yaw_rate = 0.0F) {
    OdometrySample sample;
    sample.t_us = period * kPeriodUs;
    sample.speed_mps = speed_mps;
    sample.turn = yaw_rate;
    return sample;
  }

  OdometryNoise noise_;
  OdometryMotion motion_;
};

/// Over the second in which a turn slips in one direction, twice the square of centre and yaw rate.
TEST_F(AHeldMotion, SlipsLaterallyInATurnByTheSameHoweverTimeIsCut) {
  EXPECT_EQ(motion_.lateral_slip_over(0.1F), 0.0F) << "straight ahead";
  for (int k = 21; k <= 80; ++k) motion_.take(reading(k, 1.0F, 0.5F));
  const float second = motion_.lateral_slip_over(1.0F);
  EXPECT_NEAR(second, 2.0F * square(noise_.turn_centre_m * 0.5F), 1e-5F);
  EXPECT_NEAR(50.0F * motion_.lateral_slip_over(0.02F), second, 1e-6F);
  motion_.take(reading(81, 0.0F));
  EXPECT_EQ(motion_.lateral_slip_over(0.1F), 0.0F) << "at rest, whatever the readings before";
}

TEST_F(AHeldMotion, IsTheNewestReadings) {
  EXPECT_TRUE(motion_.has_sample());
  EXPECT_FALSE(motion_.by_images());
  EXPECT_FLOAT_EQ(motion_.over(motion_.held(), 0.5F).distance_m, 0.5F);
  EXPECT_FLOAT_EQ(motion_.seconds_since_sample(25 * kPeriodUs), 0.5F);
  EXPECT_EQ(motion_.seconds_since_sample(kPeriodUs), 0.0F) << "an earlier time";
  motion_.count_from(25 * kPeriodUs);
  EXPECT_EQ(motion_.seconds_since_sample(25 * kPeriodUs), 0.0F);
  EXPECT_FLOAT_EQ(motion_.held().speed_mps, 1.0F);
}

/// The variance of a step is that of its share of a sample; slipping wheels take its place where
/// they say more.
TEST_F(AHeldMotion, HasTheSamplesNoiseOrThatOfWheelsThatSlip) {
  const PlanarIncrement<float> gripping = motion_.increment_over(0.1F, 0.0F);
  EXPECT_NEAR(gripping.covariance(0, 0), square(0.1F * noise_.sigma_speed_mps), 1e-8F);
  const PlanarIncrement<float> half = motion_.increment_over(0.05F, 0.0F);
  EXPECT_NEAR(half.covariance(0, 0), 0.5F * gripping.covariance(0, 0), 1e-8F);
  const PlanarIncrement<float> slipping = motion_.increment_over(0.1F, 2.0F);
  EXPECT_NEAR(slipping.covariance(0, 0), square(0.1F * 2.0F), 1e-6F);
  EXPECT_FLOAT_EQ(slipping.distance_m, gripping.distance_m);
}

TEST_F(AHeldMotion, IsHeldSteadilyWithoutTheLastReadingsNoise) {
  motion_.take(reading(21, 1.0F, 0.8F));
  motion_.hold_steadily();
  EXPECT_NEAR(motion_.held().turn, 0.8F * 0.1F / 0.4F, 1e-6F);  // of a low pass of 0.3 s
  motion_.take(reading(22, 0.0F));
  motion_.hold_steadily();
  EXPECT_EQ(motion_.held().speed_mps, 0.0F) << "rest is exact";
}

TEST_F(AHeldMotion, IsTheImagesToCorrectUntilTheNextReading) {
  OdometrySample steered = reading(21, 1.0F, 0.1F);
  steered.kind = OdometrySample::Kind::kAckermann;
  motion_.take(steered);
  const float yaw_rate = motion_.over(steered, 1.0F).yaw_rad;
  motion_.hold_by_images();
  motion_.correct(-0.4F, 0.3F, 24 * kPeriodUs);
  EXPECT_EQ(motion_.held().kind, OdometrySample::Kind::kTwist);
  EXPECT_FLOAT_EQ(motion_.held().speed_mps, 0.6F);
  EXPECT_FLOAT_EQ(motion_.held().turn, yaw_rate + 0.3F);
  EXPECT_FLOAT_EQ(motion_.steady().speed_mps, 0.6F);
  EXPECT_FLOAT_EQ(motion_.seconds_since_known(25 * kPeriodUs), 0.1F);
  EXPECT_FLOAT_EQ(motion_.seconds_since_sample(25 * kPeriodUs), 0.4F);
  motion_.take(reading(26, 1.0F));
  EXPECT_FALSE(motion_.by_images());
  EXPECT_EQ(motion_.seconds_since_known(26 * kPeriodUs), 0.0F);
}

/// The deviation of the path is u t^2 / 2 within the longest step of 1 s, u (t - 1 / 2) beyond it.
TEST_F(AHeldMotion, DriftsToTheUnknownWithinTheLongestStep) {
  EXPECT_NEAR(motion_.drift_between(0.0F, 1.0F).position, square(0.5F), 1e-6F);
  EXPECT_NEAR(motion_.drift_between(0.0F, 3.0F).position, square(2.5F), 1e-5F);
  EXPECT_NEAR(motion_.drift_between(0.0F, 1.0F).heading, square(0.25F), 1e-6F);
  const float parts =
      motion_.drift_between(0.0F, 0.7F).position + motion_.drift_between(0.7F, 1.0F).position;
  EXPECT_NEAR(parts, square(0.5F), 1e-6F) << "in any number of steps";
}

/// A walk between two known ends leaves a twelfth of its variance, u^2 t^3 / 12.
TEST_F(AHeldMotion, IsKnownBetterBetweenTwoReadings) {
  const OdometrySample end = reading(25, 0.0F);
  OdometrySample start = end;
  EXPECT_NEAR(motion_.drift_between_samples(start, end, 0.5F).heading,
              square(0.5F) * 0.125F / 12.0F, 1e-6F);
  start.turn = 1.0F;
  EXPECT_NEAR(motion_.drift_between_samples(start, end, 0.5F).heading,
              (square(0.5F) + 1.0F) * 0.125F / 12.0F, 1e-6F);
}

}  // namespace
}  // namespace cairn
