// What OdometryIntegrator makes of images that correct the pose.

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

#include "odometry_fixture.hpp"

namespace cairn {
namespace {

TEST_F(AVehicleWithOdometry, LeavesAloneWhatAnImageHasCorrected) {
  ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
  ASSERT_TRUE(ok(integrate_to(kPeriodUs + 50000)));
  odometry_.note_image_update(0.0F, 0.0F, 0.1F, false);
  const float at_frame = x();
  ASSERT_TRUE(ok(add(kPeriodUs + 90000, 3.0F)));
  EXPECT_NEAR(x() - at_frame, 0.12F, 1e-5F);
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

}  // namespace
}  // namespace cairn
