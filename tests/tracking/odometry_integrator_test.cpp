#include "cairn/tracking/odometry_integrator.hpp"

#include <limits>

#include <gtest/gtest.h>

#include "cairn/planar/group_iekf_slam.hpp"

namespace cairn {
namespace {

/// GIVEN a vehicle at the origin, whose odometry tells speed and yaw rate ten times a second.
class AVehicleWithOdometry : public ::testing::Test {
 protected:
  using Filter = GroupIekfSlam<float, 4, 3>;
  static constexpr std::int64_t kPeriodUs = 100000;

  AVehicleWithOdometry() {
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

TEST_F(AVehicleWithOdometry, MovesAsTold) {
  for (int k = 1; k <= 10; ++k) ASSERT_TRUE(ok(add(k * kPeriodUs, 0.5F)));
  EXPECT_NEAR(x(), 0.5F, 1e-5F);
  EXPECT_FLOAT_EQ(odometry_.speed_mps(), 0.5F);
}

TEST_F(AVehicleWithOdometry, IsAtRestBeforeTheFirstSample) {
  ASSERT_TRUE(ok(integrate_to(20 * kPeriodUs)));
  EXPECT_EQ(x(), 0.0F);
  EXPECT_EQ(health_.time_errors, 0U);
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

TEST_F(AVehicleWithOdometry, TakesALateSampleFromWhereTheFrameWas) {
  ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
  ASSERT_TRUE(ok(integrate_to(kPeriodUs + 50000)));
  const float at_frame = x();
  ASSERT_TRUE(ok(add(kPeriodUs + 40000, 3.0F)));
  EXPECT_EQ(x(), at_frame);
  ASSERT_TRUE(ok(integrate_to(kPeriodUs + 60000)));
  EXPECT_NEAR(x() - at_frame, 0.03F, 1e-5F);
}

TEST_F(AVehicleWithOdometry, RefusesWhatIsNoReading) {
  ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
  const float before = x();
  EXPECT_EQ(add(kPeriodUs, 1.0F), Status::kOk);  // told again: nothing to integrate
  EXPECT_EQ(add(kPeriodUs / 2, 1.0F), Status::kTimeBackwards);
  EXPECT_EQ(add(2 * kPeriodUs, std::numeric_limits<float>::quiet_NaN()), Status::kNonFiniteInput);
  EXPECT_EQ(add(2 * kPeriodUs, 1.0F, std::numeric_limits<float>::infinity()),
            Status::kNonFiniteInput);
  EXPECT_EQ(x(), before);
  EXPECT_EQ(health_.time_errors, 1U);
  EXPECT_EQ(health_.non_finite_inputs, 2U);
}

TEST_F(AVehicleWithOdometry, DoesNotIntegrateAGap) {
  ASSERT_TRUE(ok(add(kPeriodUs, 1.0F)));
  const float before = x();
  EXPECT_EQ(add(kPeriodUs + 1500000, 1.0F), Status::kTimeGap);
  EXPECT_EQ(x(), before);
  EXPECT_EQ(health_.time_errors, 1U);
  ASSERT_TRUE(ok(add(2 * kPeriodUs + 1500000, 1.0F)));
  EXPECT_NEAR(x() - before, 0.1F, 1e-5F);
}

/// The mean follows the reading, the noise does not: a yaw rate that is wild for one sample is as
/// uncertain as it is far from those before.
TEST_F(AVehicleWithOdometry, TrustsAWildReadingLess) {
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
};

/// Steering couples the noise of an Ackermann vehicle's turn to that of its speed. GIVEN a straight
/// course, WHEN one reading says that it is steered, THEN the vehicle turns as told, but the
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
