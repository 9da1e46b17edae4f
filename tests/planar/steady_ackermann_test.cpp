#include "cairn/planar/steady_ackermann.hpp"

#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr double kDt = 0.1;
constexpr double kWheelbase = 0.5;
constexpr double kSigmaSpeed = 0.1;
constexpr double kSigmaSteering = 0.0873;

PlanarIncrement<double> next(SteadyAckermann<double>& odometry, double speed, double steering) {
  return odometry.increment(speed, steering, kDt, kWheelbase, kSigmaSpeed, kSigmaSteering);
}

TEST(SteadyAckermann, MovesByTheReading) {
  SteadyAckermann<double> odometry(0.3);
  for (const double steering : {0.0, 0.2, -0.1}) {
    const auto plain =
        ackermann_increment(0.5, steering, kDt, kWheelbase, kSigmaSpeed, kSigmaSteering);
    const auto steady = next(odometry, 0.5, steering);
    EXPECT_EQ(steady.distance_m, plain.distance_m);
    EXPECT_EQ(steady.turn_rad, plain.turn_rad);
  }
}

TEST(SteadyAckermann, LinearisesAtTheReadingWithoutLowPass) {
  SteadyAckermann<double> odometry(0.0);
  for (const double steering : {0.1, -0.2}) {
    const auto plain =
        ackermann_increment(0.5, steering, kDt, kWheelbase, kSigmaSpeed, kSigmaSteering);
    EXPECT_EQ(next(odometry, 0.5, steering).covariance, plain.covariance);
  }
}

/// Straight ahead with noisy steering: the covariance of distance and turn is zero in truth. At the
/// reading it follows the reading's own error, with a time constant of three steps a quarter as
/// much.
TEST(SteadyAckermann, CorrelatesDistanceAndTurnLessThanTheReading) {
  SteadyAckermann<double> steady(0.3);
  SteadyAckermann<double> plain(0.0);
  std::mt19937_64 generator(1);
  std::normal_distribution<double> noise(0.0, kSigmaSteering);
  double with_own_error[2] = {};
  for (int k = 0; k < 2000; ++k) {
    const double error = noise(generator);
    with_own_error[0] += error * next(plain, 0.5, error).covariance(0, 1);
    with_own_error[1] += error * next(steady, 0.5, error).covariance(0, 1);
  }
  EXPECT_GT(with_own_error[0], 0.0);
  EXPECT_NEAR(with_own_error[1] / with_own_error[0], 0.25, 0.05);
}

TEST(SteadyAckermann, RefusedReadingsDoNotEnterTheLowPass) {
  SteadyAckermann<double> odometry(0.3);
  SteadyAckermann<double> undisturbed(0.3);
  (void)next(odometry, 0.5, 0.1);
  (void)next(undisturbed, 0.5, 0.1);
  EXPECT_FALSE(ok(validate(next(odometry, 0.5, 1.5))));
  EXPECT_FALSE(ok(validate(next(odometry, std::numeric_limits<double>::quiet_NaN(), 0.1))));
  EXPECT_EQ(next(odometry, 0.5, 0.2).covariance, next(undisturbed, 0.5, 0.2).covariance);
}

}  // namespace
}  // namespace cairn
