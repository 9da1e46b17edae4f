#include "cairn/tracking/gyro_calibration.hpp"

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"
#include "cairn/tracking/handheld_gyro.hpp"

namespace cairn {
namespace {

constexpr std::int64_t kFrameUs = 33333;
constexpr std::int64_t kSampleUs = 5000;

/// GIVEN a hand that turns a camera to and fro about all axes, with up to 1.4 rad/s, its pictures
/// and a gyroscope with a bias and late stamps.
struct Hand {
  Vector3<float> bias = Vector3<float>::Zero();
  std::int64_t late_us = 0;
  Quaternion<float> mounting = Quaternion<float>(1.0F, 0.0F, 0.0F, 0.0F);  ///< error, R_true_told
  float sigma_seen = 1e-3F;
  std::uint64_t seed = 1;

  static Vector3<float> rate(double t_s) {
    const auto wave = [t_s](double hz, double phase) {
      float sine = 0.0F;
      float cosine = 0.0F;
      sin_cos(static_cast<float>(6.2831853 * hz * t_s + phase), sine, cosine);
      return sine;
    };
    return {0.8F * wave(0.7, 0.3), 0.9F * wave(0.45, 1.0), 0.6F * wave(1.1, 2.0)};
  }

  HandheldGyro run(double seconds, const GyroParameters& parameters = {}) const {
    HandheldGyro gyro;
    gyro.reset(parameters);
    Random random(seed);
    const auto noise = [&random](float sigma) {
      float sum = 0.0F;
      for (int i = 0; i < 12; ++i) sum += static_cast<float>(random.below(1 << 16)) / 65536.0F;
      return sigma * (sum - 6.0F);
    };
    Health health;
    Quaternion<float> truth(1.0F, 0.0F, 0.0F, 0.0F);
    std::int64_t next_us = 0;
    std::int64_t done_us = 0;
    for (std::int64_t t_us = 0; t_us < static_cast<std::int64_t>(1e6 * seconds); t_us += kFrameUs) {
      for (; next_us <= t_us; next_us += kSampleUs) {
        const Vector3<float> own =
            mounting * rate(1e-6 * static_cast<double>(next_us - late_us)) + bias;
        static_cast<void>(gyro.add({next_us, own}, health));
      }
      for (; done_us < t_us; done_us += 1000) {
        const std::int64_t step_us = t_us - done_us < 1000 ? t_us - done_us : 1000;
        const double middle_s =
            1e-6 * static_cast<double>(done_us) + 0.5e-6 * static_cast<double>(step_us);
        truth = truth *
                rotation_exp(Vector3<float>(1e-6F * static_cast<float>(step_us) * rate(middle_s)));
      }
      done_us = t_us;
      gyro.take_frame(t_us);
      SeenAttitude seen;
      const Vector3<float> turned{noise(sigma_seen), noise(sigma_seen), noise(sigma_seen)};
      seen.R_world_camera = truth * rotation_exp(turned);
      seen.variance = square(sigma_seen);
      gyro.note_pose(seen);
    }
    return gyro;
  }
};

TEST(GyroCalibration, FindsTheBiasWithinItsSigma) {
  int within = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Hand hand;
    hand.seed = seed;
    hand.bias = Vector3<float>(0.02F, -0.015F, 0.01F);
    const HandheldGyro gyro = hand.run(10.0);
    EXPECT_EQ(gyro.calibration().trust(), GyroTrust::kAgrees);
    EXPECT_LT(gyro.calibration().bias_sigma(), 0.003F);
    const Vector3<float> off = gyro.calibration().bias() - hand.bias;
    within += off.norm() < 3.0F * gyro.calibration().bias_sigma() ? 1 : 0;
  }
  EXPECT_GE(within, 19);
}

TEST(GyroCalibration, FindsThatStampsAreLate) {
  for (const std::int64_t late_us : {-20000, 0, 10000, 25000}) {
    Hand hand;
    hand.late_us = late_us;
    const GyroCalibration found = hand.run(10.0).calibration();
    EXPECT_NEAR(found.time_offset_s(), 1e-6F * static_cast<float>(late_us),
                3.0F * found.time_offset_sigma_s())
        << late_us;
    EXPECT_LT(found.time_offset_sigma_s(), 0.003F);
    EXPECT_EQ(found.trust(), GyroTrust::kAgrees);
  }
}

TEST(GyroCalibration, SaysThatAGyroscopeIsMountedOtherwise) {
  const Quaternion<float> wrong[] = {
      {0.0F, 1.0F, 0.0F, 0.0F},               // 180 degrees about x
      {0.0F, 0.0F, 1.0F, 0.0F},               // y
      {0.0F, 0.0F, 0.0F, 1.0F},               // z
      {0.70710678F, 0.0F, 0.70710678F, 0.0F}  // 90 degrees about y
  };
  for (const Quaternion<float>& mounting : wrong) {
    Hand hand;
    hand.mounting = mounting;
    const HandheldGyro gyro = hand.run(3.0);
    EXPECT_EQ(gyro.calibration().trust(), GyroTrust::kContradicted);
    EXPECT_FALSE(gyro.predicts());
    // And it has learnt nothing from it.
    EXPECT_LT(gyro.calibration().bias().norm(), 0.05F);
  }
}

TEST(GyroCalibration, SaysNothingOfACameraThatStands) {
  GyroCalibration calibration;
  calibration.reset(GyroParameters{});
  GyroTurn turn;
  turn.known = true;
  turn.seconds = 0.033F;
  for (int i = 0; i < 300; ++i) {
    SeenAttitude seen;
    seen.variance = 1e-6F;
    static_cast<void>(calibration.add(turn, seen));
  }
  EXPECT_EQ(calibration.trust(), GyroTrust::kUnproven);
  EXPECT_EQ(calibration.ways(), 0);
  EXPECT_LT(calibration.bias_sigma(), 0.005F);
}

TEST(GyroCalibration, AWrongFocalLengthIsNoBias) {
  Hand hand;
  HandheldGyro gyro;
  gyro.reset(GyroParameters{});
  Health health;
  // The pictures' turns about y are 8 % too large, one way all the time.
  for (int k = 0; k < 300; ++k) {
    const std::int64_t t_us = k * kFrameUs;
    for (std::int64_t s = 0; s < 6; ++s) {
      static_cast<void>(gyro.add({t_us + s * 5500, Vector3<float>(0.0F, 0.5F, 0.0F)}, health));
    }
    gyro.take_frame(t_us);
    SeenAttitude seen;
    const float turned = 0.5F * 1.08F * 1e-6F * static_cast<float>(t_us);
    seen.R_world_camera = rotation_exp(Vector3<float>(0.0F, wrap_angle(turned), 0.0F));
    seen.variance = 1e-6F;
    seen.focal_sigma = 0.1F;
    gyro.note_pose(seen);
  }
  // 0.04 rad/s would be a bias of two sigma, or a scale of less than one: mostly the latter.
  EXPECT_LT(gyro.calibration().bias().norm(), 0.02F);
  EXPECT_GT(gyro.calibration().bias_sigma(), 0.01F);
}

TEST(HandheldGyro, TheTurnSinceAKeyframeIsThatOfItsFrames) {
  const Hand hand;
  HandheldGyro gyro = hand.run(3.0);
  ASSERT_TRUE(gyro.sure());
  Quaternion<float> turned;
  float variance = 0.0F;
  gyro.note_keyframe();
  EXPECT_FALSE(gyro.since_keyframe(turned, variance));
  Health health;
  const std::int64_t last_us = 2999970;
  std::int64_t next_us = 3000000;
  for (int k = 1; k <= 3; ++k) {
    const std::int64_t t_us = last_us + 50000 * k;
    for (; next_us < t_us + 20000; next_us += kSampleUs) {
      ASSERT_EQ(gyro.add({next_us, Vector3<float>(0.0F, 0.0F, 1.0F)}, health), Status::kOk);
    }
    gyro.take_frame(t_us);
    EXPECT_TRUE(gyro.turn().known);
  }
  ASSERT_TRUE(gyro.since_keyframe(turned, variance));
  EXPECT_GT(variance, gyro.turn_variance());
  EXPECT_NEAR(rotation_log(turned).z(), 0.15F, 0.02F);  // less the bias and offset that it believes
  // A frame without samples breaks it.
  gyro.take_frame(last_us + 900000);
  EXPECT_FALSE(gyro.since_keyframe(turned, variance));
}

}  // namespace
}  // namespace cairn
