#include "cairn/tracking/odometry_trust.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

/// GIVEN an odometry of 1 m/s, ten samples a second, WHEN samples and images say something else.
class ATrustInOdometry : public ::testing::Test {
 protected:
  static constexpr std::int64_t kPeriodUs = 100000;
  static constexpr float kPeriodS = 0.1F;

  void SetUp() override {
    motion_.reset(noise_, 1000000, 0);
    for (int k = 0; k < 20; ++k) motion_.take(next(1.0F));
    trust_.reset();
  }
  OdometrySample next(float speed_mps) {
    OdometrySample sample;
    sample.t_us = t_us_ += kPeriodUs;
    sample.speed_mps = speed_mps;
    return sample;
  }
  /// Whether a sample is taken for a glitch; the motion is held on then.
  bool glitches(float speed_mps) {
    const OdometrySample sample = next(speed_mps);
    const bool glitch = trust_.is_glitch(sample, motion_);
    if (glitch) {
      motion_.count_from(sample.t_us);
    } else {
      motion_.take(sample);
    }
    return glitch;
  }
  /// Images that move the pose by so much a second, until they contradict the samples.
  bool contradicted_by(float excess_mps) {
    for (int k = 0; k < 10; ++k) {
      if (trust_.note_image(excess_mps * kPeriodS, kPeriodS, motion_)) return true;
    }
    return false;
  }

  OdometryNoise noise_;
  OdometryMotion motion_;
  OdometryTrust trust_;
  std::int64_t t_us_ = 0;
};

/// 20 m/s^2 in a tenth of a second, and six standard deviations of a sample: 2.6 m/s.
TEST_F(ATrustInOdometry, TakesAJumpBeyondAVehiclesForAGlitchUntilItStays) {
  EXPECT_FALSE(glitches(3.5F));
  EXPECT_TRUE(glitches(7.0F));
  EXPECT_TRUE(glitches(9.0F)) << "the second in a row, and like the first";
  EXPECT_FALSE(glitches(9.1F));
  EXPECT_FLOAT_EQ(trust_.slip_mps(), 3.5F) << "at most the vehicle's own speed";
}

TEST_F(ATrustInOdometry, BelievesNoJumpsThatDiffer) {
  for (int k = 0; k < 6; ++k) EXPECT_TRUE(glitches(k % 2 == 0 ? 20.0F : 50.0F)) << k;
}

TEST_F(ATrustInOdometry, NotesASlipBeyondTheNoiseAndForgetsIt) {
  trust_.note_slip(0.2F, kPeriodS, motion_);
  EXPECT_EQ(trust_.slip_mps(), 0.0F) << "two standard deviations";
  trust_.note_slip(0.8F, kPeriodS, motion_);
  EXPECT_FLOAT_EQ(trust_.slip_mps(), 0.8F);
  trust_.note_slip(50.0F, kPeriodS, motion_);
  EXPECT_FLOAT_EQ(trust_.slip_mps(), 1.0F) << "the vehicle's own speed";
  trust_.fade(0.5F);
  EXPECT_FLOAT_EQ(trust_.slip_mps(), 0.5F);
}

TEST_F(ATrustInOdometry, LetsImagesContradictByMoreThanAFifth) {
  EXPECT_FALSE(contradicted_by(0.3F));
  EXPECT_FALSE(trust_.doubts());
  EXPECT_TRUE(contradicted_by(-0.8F));
  EXPECT_TRUE(trust_.doubts());
}

/// The images hold 1 m/s while samples say 2: contradicted for ten seconds, then believed, and
/// doubted for as long.
TEST_F(ATrustInOdometry, BelievesAndDoubtsSamplesThatWereContradictedForLong) {
  ASSERT_TRUE(contradicted_by(-1.0F));
  motion_.hold_by_images();
  int refused = 0;
  for (; refused < 200; ++refused) {
    const OdometrySample sample = next(2.0F);
    motion_.correct(0.0F, 0.0F, sample.t_us);
    if (!trust_.is_contradicted(sample, motion_)) break;
    motion_.count_from(sample.t_us);
  }
  EXPECT_NEAR(static_cast<float>(refused) * kPeriodS, OdometryTrust::kLongestContradiction_s, 0.2F);
  for (int k = 0; k < 95; ++k) trust_.fade(kPeriodS);
  EXPECT_TRUE(trust_.doubts());
  for (int k = 0; k < 10; ++k) trust_.fade(kPeriodS);
  EXPECT_FALSE(trust_.doubts());
}

TEST_F(ATrustInOdometry, IsBackWhereTheSamplesAgreeOrTheImagesAreBlind) {
  ASSERT_TRUE(contradicted_by(-1.0F));
  motion_.hold_by_images();
  OdometrySample sample = next(1.0F);
  motion_.correct(0.0F, 0.0F, sample.t_us);
  for (int k = 0; k < 10 && trust_.is_contradicted(sample, motion_); ++k) {
    motion_.count_from(sample.t_us);
    sample = next(1.0F);
    motion_.correct(0.0F, 0.0F, sample.t_us);
  }
  EXPECT_FALSE(trust_.doubts()) << "they agree again";
  ASSERT_TRUE(contradicted_by(-1.0F));
  t_us_ += 5 * kPeriodUs;  // without an image
  EXPECT_FALSE(trust_.is_contradicted(next(2.0F), motion_));
  EXPECT_FLOAT_EQ(trust_.slip_mps(), noise_.unknown_speed_mps);
}

}  // namespace
}  // namespace cairn
