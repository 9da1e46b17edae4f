#pragma once

#include <cstdint>

#include <gtest/gtest.h>

#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/tracking/odometry_integrator.hpp"

namespace cairn {

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

}  // namespace cairn
