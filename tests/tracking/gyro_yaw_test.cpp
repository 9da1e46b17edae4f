#include "cairn/tracking/gyro_yaw.hpp"

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

/// GIVEN a camera that looks forward on a vehicle, and a gyroscope in the camera's axes.
class GyroOnVehicle : public ::testing::Test {
 protected:
  GyroOnVehicle() {
    T_vehicle_camera_.rotation = Quaternion<float>(0.5F, -0.5F, 0.5F, -0.5F);
    yaw_.reset(parameters_, T_vehicle_camera_);
  }
  /// The vehicle yaws; the camera's y axis points down.
  void sense_until(std::int64_t t_us, float yaw_rate) {
    for (; next_us_ <= t_us; next_us_ += 5000) {
      ASSERT_EQ(yaw_.add({next_us_, Vector3<float>(0.0F, -(yaw_rate + bias_), 0.0F)}, health_),
                Status::kOk);
    }
  }
  OdometrySample drive(int k, float speed, float wheels, float yaw_rate) {
    const std::int64_t t_us = 100000 * k;
    sense_until(t_us, yaw_rate);
    return yaw_.replace({t_us, OdometrySample::Kind::kTwist, speed, wheels}, 0.05F);
  }

  GyroParameters parameters_;
  Rigid<float> T_vehicle_camera_;
  GyroYaw yaw_;
  Health health_;
  std::int64_t next_us_ = 0;
  float bias_ = 0.0F;
};

TEST_F(GyroOnVehicle, ItsYawRateTakesThePlaceOfTheWheels) {
  static_cast<void>(drive(0, 1.0F, 0.0F, 0.3F));
  const OdometrySample sample = drive(1, 1.0F, 0.1F, 0.3F);
  EXPECT_EQ(sample.kind, OdometrySample::Kind::kTwist);
  EXPECT_EQ(sample.speed_mps, 1.0F);
  EXPECT_NEAR(sample.turn, 0.3F, 0.005F);
}

TEST_F(GyroOnVehicle, ASteeringAngleBecomesAYawRate) {
  sense_until(0, 0.2F);
  static_cast<void>(yaw_.replace({0, OdometrySample::Kind::kAckermann, 1.0F, 0.5F}, 0.05F));
  sense_until(100000, 0.2F);
  const OdometrySample sample =
      yaw_.replace({100000, OdometrySample::Kind::kAckermann, 1.0F, 0.5F}, 0.05F);
  EXPECT_EQ(sample.kind, OdometrySample::Kind::kTwist);
  EXPECT_NEAR(sample.turn, 0.2F, 1e-3F);
}

TEST_F(GyroOnVehicle, AtRestItReadsItsBias) {
  bias_ = 0.03F;
  for (int k = 0; k < 20; ++k) {
    const OdometrySample sample = drive(k, 0.0F, 0.0F, 0.0F);
    EXPECT_EQ(sample.turn, 0.0F);
  }
  EXPECT_NEAR(yaw_.bias_radps(), 0.03F, 3.0F * yaw_.bias_sigma_radps());
  EXPECT_LT(yaw_.bias_sigma_radps(), 0.002F);
  static_cast<void>(drive(20, 1.0F, 0.5F, 0.5F));
  EXPECT_NEAR(drive(21, 1.0F, 0.5F, 0.5F).turn, 0.5F, 0.005F);
}

TEST_F(GyroOnVehicle, OnTheWayTheWheelsTellTheBiasSlowly) {
  bias_ = 0.03F;
  for (int k = 0; k < 600; ++k) {
    static_cast<void>(drive(k, 1.0F, k % 2 == 0 ? 0.05F : -0.05F, 0.0F));
  }
  EXPECT_NEAR(yaw_.bias_radps(), 0.03F, 3.0F * yaw_.bias_sigma_radps());
  EXPECT_LT(yaw_.bias_sigma_radps(), 0.01F);
  EXPECT_GT(yaw_.bias_sigma_radps(), 0.002F);
}

TEST_F(GyroOnVehicle, WithoutItsSamplesTheWheelsCount) {
  static_cast<void>(drive(0, 1.0F, 0.1F, 0.3F));
  OdometrySample sample{500000, OdometrySample::Kind::kTwist, 1.0F, 0.1F};
  const OdometrySample same = yaw_.replace(sample, 0.05F);
  EXPECT_EQ(same.turn, 0.1F);
}

}  // namespace
}  // namespace cairn
