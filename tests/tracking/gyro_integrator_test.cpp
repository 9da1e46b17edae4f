#include "cairn/tracking/gyro_integrator.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr std::int64_t kSecondUs = 1000000;

GyroParameters parameters() {
  GyroParameters p;
  p.noise_density = 1e-3F;
  return p;
}

/// A gyroscope that turns about one axis at a rate that grows by 6 rad/s^2 from 1 rad/s.
struct Speeding {
  Vector3<float> axis = Vector3<float>(0.6F, -0.8F, 0.0F);
  float rate(double t_s) const { return 1.0F + 6.0F * static_cast<float>(t_s); }
  float angle(double t_s) const {
    return static_cast<float>(t_s) + 3.0F * static_cast<float>(t_s * t_s);
  }
  AngularRateSample sample(std::int64_t t_us) const {
    return {t_us, rate(1e-6 * static_cast<double>(t_us)) * axis};
  }
};

/// WHEN samples of a rate come between frames at 30 Hz, not at their times, each frame late by
/// `late_us` of samples, THEN its turn is that of the closed form.
void expect_turns(std::int64_t period_us, std::int64_t late_us, float tolerance) {
  const Speeding motion;
  GyroIntegrator integrator;
  integrator.reset(parameters());
  Health health;
  std::int64_t next_us = 777;
  std::int64_t before_us = 0;
  for (int frame = 0; frame < 20; ++frame) {
    const std::int64_t t_us = 20000 + 33333 * frame;
    for (; next_us <= t_us + late_us; next_us += period_us) {
      ASSERT_EQ(integrator.add(motion.sample(next_us), health), Status::kOk);
    }
    const GyroTurn turn = integrator.take_frame(t_us);
    ASSERT_EQ(turn.known, frame > 0) << frame;
    if (frame > 0) {
      const float angle = motion.angle(1e-6 * static_cast<double>(t_us)) -
                          motion.angle(1e-6 * static_cast<double>(before_us));
      EXPECT_LT((turn.rotation - angle * motion.axis).norm(), tolerance) << frame;
      EXPECT_NEAR(turn.seconds, 0.033333F, 1e-6F);
      EXPECT_GE(turn.variance, 1e-6F * turn.seconds);
    }
    before_us = t_us;
  }
  EXPECT_EQ(integrator.refused(), 0U);
  EXPECT_EQ(integrator.gaps(), 0U);
}

TEST(GyroIntegrator, TurnsOfFramesBetweenSamplesFollowTheClosedForm) {
  // A rate that is linear between the samples is exact, but for what is held at a frame's time:
  // 6 rad/s^2 over at most a period, at both ends.
  expect_turns(500, 0, 3e-6F);
  expect_turns(5000, 0, 2e-4F);
  expect_turns(20000, 0, 2.5e-3F);
  expect_turns(500, 40000, 3e-6F);
  expect_turns(5000, 40000, 3e-6F);
  expect_turns(20000, 40000, 3e-6F);
}

TEST(GyroIntegrator, WhatWasHeldAtAFrameIsCorrectedByTheNextSample) {
  const Speeding motion;
  GyroIntegrator integrator;
  integrator.reset(parameters());
  Health health;
  for (std::int64_t t = 0; t <= 100000; t += 20000) {
    ASSERT_EQ(integrator.add(motion.sample(t), health), Status::kOk);
  }
  static_cast<void>(integrator.take_frame(115000));
  for (std::int64_t t = 120000; t <= 200000; t += 20000) {
    ASSERT_EQ(integrator.add(motion.sample(t), health), Status::kOk);
  }
  const GyroTurn turn = integrator.take_frame(200000);
  ASSERT_TRUE(turn.known);
  const float angle = motion.angle(0.2) - motion.angle(0.115);
  EXPECT_LT((turn.rotation - angle * motion.axis).norm(), 1e-5F);
}

TEST(GyroIntegrator, RatesAreTurnedToTheCameraAndTheBiasIsTakenOff) {
  GyroParameters p = parameters();
  p.R_camera_gyro = Quaternion<float>(0.0F, 0.0F, 0.0F, 1.0F);  // 180 degrees about z
  GyroIntegrator integrator;
  integrator.reset(p);
  integrator.set_bias(Vector3<float>(-0.1F, 0.0F, 0.02F));
  Health health;
  for (std::int64_t t = 0; t <= 100000; t += 5000) {
    ASSERT_EQ(integrator.add({t, Vector3<float>(1.0F, 0.5F, 0.25F)}, health), Status::kOk);
  }
  static_cast<void>(integrator.take_frame(0));
  const GyroTurn turn = integrator.take_frame(100000);
  ASSERT_TRUE(turn.known);
  const Vector3<float> rate(-0.9F, -0.5F, 0.23F);
  EXPECT_LT((turn.rotation - 0.1F * rate).norm(), 1e-5F);
  EXPECT_LT((turn.rate_after - rate).norm(), 1e-6F);
}

TEST(GyroIntegrator, AnOffsetOfTheStampsIsTakenIntoAccount) {
  const Speeding motion;
  GyroIntegrator integrator;
  integrator.reset(parameters());
  Health health;
  // Stamps are late by 12 ms.
  for (std::int64_t t = 0; t <= 300000; t += 5000) {
    AngularRateSample sample = motion.sample(t);
    sample.t_us += 12000;
    ASSERT_EQ(integrator.add(sample, health), Status::kOk);
  }
  static_cast<void>(integrator.take_frame(200000));
  integrator.set_time_offset(0.012F);
  const GyroTurn turn = integrator.take_frame(250000);
  ASSERT_TRUE(turn.known);
  const float angle = motion.angle(0.25) - motion.angle(0.2);
  EXPECT_LT((turn.rotation - angle * motion.axis).norm(), 1e-5F);
}

/// A gyroscope at rest, 100 Hz, up to a time.
void rest_until(GyroIntegrator& integrator, Health& health, std::int64_t from_us,
                std::int64_t to_us) {
  for (std::int64_t t = from_us; t <= to_us; t += 10000) {
    ASSERT_EQ(integrator.add({t, Vector3<float>::Zero()}, health), Status::kOk);
  }
}

TEST(GyroIntegrator, AGapLeavesTheTurnUnknown) {
  GyroIntegrator integrator;
  integrator.reset(parameters());
  Health health;
  rest_until(integrator, health, 0, 100000);
  static_cast<void>(integrator.take_frame(100000));
  rest_until(integrator, health, 200000, 300000);
  EXPECT_FALSE(integrator.take_frame(220000).known);
  EXPECT_TRUE(integrator.take_frame(300000).known);
  EXPECT_EQ(integrator.gaps(), 1U);
  // Beyond the newest sample it is held for the longest gap.
  EXPECT_TRUE(integrator.take_frame(350000).known);
  EXPECT_FALSE(integrator.take_frame(350001).known);
}

TEST(GyroIntegrator, ASaturatedSampleIsAGap) {
  GyroIntegrator integrator;
  integrator.reset(parameters());
  Health health;
  rest_until(integrator, health, 0, 100000);
  static_cast<void>(integrator.take_frame(100000));
  EXPECT_EQ(integrator.add({110000, Vector3<float>(0.0F, -34.0F, 0.0F)}, health), Status::kGated);
  rest_until(integrator, health, 120000, 200000);
  EXPECT_FALSE(integrator.take_frame(150000).known);
  EXPECT_TRUE(integrator.take_frame(200000).known);
  EXPECT_EQ(integrator.saturated(), 1U);
}

TEST(GyroIntegrator, RefusesWhatCannotBeAndCountsIt) {
  GyroIntegrator integrator;
  integrator.reset(parameters());
  Health health;
  rest_until(integrator, health, 0, 100000);
  static_cast<void>(integrator.take_frame(50000));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto refuses = [&](std::int64_t t_us, float rate, Status status) {
    EXPECT_EQ(integrator.add({t_us, Vector3<float>(rate, 0.0F, 0.0F)}, health), status);
  };
  refuses(110000, nan, Status::kNonFiniteInput);
  refuses(110000, 201.0F, Status::kInvalidArgument);
  refuses(100000, 1.0F, Status::kDuplicate);
  refuses(90000, 1.0F, Status::kTimeBackwards);
  refuses(100 * kSecondUs, 1.0F, Status::kTimeGap);
  refuses(-100 * kSecondUs, 1.0F, Status::kTimeBackwards);
  EXPECT_EQ(integrator.refused(), 6U);
  EXPECT_EQ(health.non_finite_inputs, 1U);
  EXPECT_EQ(health.time_errors, 4U);
  EXPECT_EQ(integrator.taken(), 11U);
  const GyroTurn turn = integrator.take_frame(100000);
  ASSERT_TRUE(turn.known);
  EXPECT_EQ(turn.rotation.norm(), 0.0F);
  EXPECT_EQ(integrator.gaps(), 0U);
}

TEST(GyroIntegrator, AClockThatWasSetBackStartsAnew) {
  GyroIntegrator integrator;
  integrator.reset(parameters());
  Health health;
  rest_until(integrator, health, 50 * kSecondUs, 50 * kSecondUs + 100000);
  EXPECT_EQ(integrator.add({0, Vector3<float>::Zero()}, health), Status::kTimeBackwards);
  rest_until(integrator, health, 10000, 100000);
  static_cast<void>(integrator.take_frame(50000));
  EXPECT_TRUE(integrator.take_frame(100000).known);
}

TEST(GyroIntegrator, AFrameBeforeTheFirstSampleHasNoTurn) {
  GyroIntegrator integrator;
  integrator.reset(parameters());
  Health health;
  EXPECT_FALSE(integrator.take_frame(0).known);
  rest_until(integrator, health, 10000, 50000);
  EXPECT_FALSE(integrator.take_frame(5000).known);
  EXPECT_FALSE(integrator.take_frame(50000).known);
  EXPECT_FALSE(integrator.take_frame(std::numeric_limits<std::int64_t>::max()).known);
}

TEST(GyroParameters, RefusesImpossibleValues) {
  EXPECT_EQ(GyroParameters{}.validate(), Status::kOk);
  const auto refuses = [](auto change) {
    GyroParameters p;
    change(p);
    EXPECT_EQ(p.validate(), Status::kBadConfig);
  };
  refuses([](GyroParameters& p) { p.R_camera_gyro.w() = 0.9F; });
  refuses([](GyroParameters& p) { p.noise_density = 0.0F; });
  refuses([](GyroParameters& p) { p.bias_sigma_radps = -1.0F; });
  refuses([](GyroParameters& p) { p.bias_walk = std::numeric_limits<float>::infinity(); });
  refuses([](GyroParameters& p) { p.scale_sigma = 2.0F; });
  refuses([](GyroParameters& p) { p.time_sigma_s = -0.1F; });
  refuses([](GyroParameters& p) { p.range_radps = 0.0F; });
  refuses([](GyroParameters& p) { p.max_gap_us = 0; });
}

}  // namespace
}  // namespace cairn
