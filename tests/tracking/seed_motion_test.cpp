#include "cairn/tracking/seed_motion.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

struct EstimateOfATilt {
  Rigid<float> mount;
  Matrix2<float> covariance = Matrix2<float>::Zero();
  Vector2<float> noise = Vector2<float>::Zero();

  const Rigid<float>& T_vehicle_camera() const { return mount; }
  const Matrix2<float>& tilt_covariance() const { return covariance; }
  const Vector2<float>& tilt_noise(float) const { return noise; }
};

/// GIVEN a vehicle whose camera looks ahead (its x to the right, y down) or to the left.
class SeedsInMotion : public ::testing::Test {
 protected:
  SeedsInMotion() { look_ahead(); }
  void look_ahead() {
    Matrix3<float> R;
    R << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    estimate_.mount.rotation = Quaternion<float>(R);
  }
  void look_left() {
    Matrix3<float> R;
    R << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    estimate_.mount.rotation = Quaternion<float>(R);
  }
  SeedParameters seeds() const { return seeds_in_motion(parameters_, noise_, estimate_, motion_); }

  EstimateOfATilt estimate_;
  SeedParameters parameters_;
  SeedNoise noise_;
  VehicleMotion motion_{1.0F, 0.1F, 0.0F, true};
};

TEST_F(SeedsInMotion, OfALevelVehicleGrowWithTheRootOfTime) {
  const SeedParameters tenth = seeds();
  motion_.step_s = 0.4F;
  const SeedParameters longer = seeds();
  EXPECT_NEAR(longer.sigma_pitch_rad, 2.0F * tenth.sigma_pitch_rad, 1e-6F);
  EXPECT_NEAR(longer.sigma_yaw_rad, 2.0F * tenth.sigma_yaw_rad, 1e-6F);
  EXPECT_EQ(tenth.sigma_roll_rad, 0.0F);
}

TEST_F(SeedsInMotion, TakeTheVehiclesPitchAboutTheCamerasAxes) {
  noise_.pitch = 0.0F;
  estimate_.covariance(0, 0) = 1e-4F;  // of pitch
  estimate_.noise = Vector2<float>(9e-6F, 0.0F);
  EXPECT_NEAR(seeds().sigma_pitch_rad, 3e-3F, 1e-6F);
  EXPECT_NEAR(seeds().sigma_roll_rad, 0.0F, 1e-6F);
  look_left();
  EXPECT_NEAR(seeds().sigma_pitch_rad, 0.0F, 1e-6F);
  EXPECT_NEAR(seeds().sigma_roll_rad, 1.4142e-2F, 1e-5F);
}

TEST_F(SeedsInMotion, TrustATiltThatIsKnownBetterThanItsNoise) {
  noise_.pitch = 0.0F;
  estimate_.covariance(0, 0) = 1e-6F;
  estimate_.noise = Vector2<float>(9e-6F, 0.0F);
  EXPECT_NEAR(seeds().sigma_pitch_rad, 1.4142e-3F, 1e-6F);
}

TEST_F(SeedsInMotion, ExpectFartherPointsFromAFastVehicle) {
  EXPECT_EQ(seeds().initial_depth_m, parameters_.initial_depth_m);
  motion_.speed_mps = -10.0F;
  EXPECT_FLOAT_EQ(seeds().initial_depth_m, 12.0F);
  EXPECT_FLOAT_EQ(seeds().initial_sigma_rho, 1.0F / 12.0F);
  EXPECT_FLOAT_EQ(seeds().max_depth_m, 60.0F);
}

}  // namespace
}  // namespace cairn
