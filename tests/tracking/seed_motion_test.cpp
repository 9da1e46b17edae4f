#include "cairn/tracking/seed_motion.hpp"

#include <gtest/gtest.h>

#include "cairn/planar/group_iekf_slam.hpp"

namespace cairn {
namespace {

struct EstimateOfATilt {
  Rigid<float> mount;
  PinholeCamera<float> lens;
  Matrix2<float> covariance = Matrix2<float>::Zero();
  Vector2<float> noise = Vector2<float>::Zero();

  const Rigid<float>& T_vehicle_camera() const { return mount; }
  const PinholeCamera<float>& camera() const { return lens; }
  Matrix2<float> tilt_covariance() const { return covariance; }
  Vector2<float> tilt_noise(float) const { return noise; }
};

/// GIVEN a vehicle whose camera looks ahead (its x to the right, y down) or to the left.
class SeedsInMotion : public ::testing::Test {
 protected:
  SeedsInMotion() {
    look_ahead();
    estimate_.lens.fx = 400.0F;
  }
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
  /// From the camera now to where it is when a seed's depth can be known.
  Rigid<float> later_now(const SeedParameters& seeds) const {
    return camera_after(motion_, seeds.min_views - 1, estimate_.mount).inverse();
  }

  EstimateOfATilt estimate_;
  SeedParameters parameters_;
  SeedNoise noise_;
  VehicleMotion motion_{1.0F, 0.1F, 0.0F, 0};
};

TEST_F(SeedsInMotion, OfALevelVehicleGrowWithTheRootOfTime) {
  const SeedParameters tenth = seeds();
  motion_.step_s = 0.4F;
  const SeedParameters longer = seeds();
  EXPECT_NEAR(longer.sigma_pitch_rad, 2.0F * tenth.sigma_pitch_rad, 1e-6F);
  EXPECT_EQ(tenth.sigma_roll_rad, 0.0F);
}

TEST_F(SeedsInMotion, KnowTheYawFromOdometryAndInliersTogether) {
  motion_.yaw_variance = 4e-6F;
  EXPECT_NEAR(seeds().sigma_yaw_rad, 2.1e-3F, 1e-6F);
  motion_.inliers = 4;
  noise_.inlier_px = 1.68F;
  EXPECT_NEAR(seeds().sigma_yaw_rad, 1.485e-3F, 1e-6F) << "both say it to 2.1e-3";
  motion_.yaw_variance = 1.0F;
  EXPECT_NEAR(seeds().sigma_yaw_rad, 2.1e-3F, 1e-6F);
  estimate_.lens.fx = 100.0F;
  EXPECT_NEAR(seeds().sigma_yaw_rad, 8.4e-3F, 1e-6F) << "a pixel is four times as wide";
}

TEST_F(SeedsInMotion, AllowForAPathThatIsNotKnownExactly) {
  EXPECT_EQ(parameters_.off_path, 0.0F);
  EXPECT_EQ(seeds().off_path, noise_.off_path);
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

PinholeCamera<float> wide_camera() {
  PinholeCamera<float> camera;
  camera.fx = camera.fy = 100.0F;
  camera.cx = camera.cy = 99.5F;
  camera.width = camera.height = 200;
  return camera;
}

/// Looking ahead, what lies at the border is passed first.
TEST_F(SeedsInMotion, LeaveAtTheBorderWhereTheCameraLooksAhead) {
  motion_.speed_mps = 10.0F;
  const PinholeCamera<float> camera = wide_camera();
  const SeedParameters later = seeds();
  ASSERT_EQ(later.min_views, 3) << "2 m to go at 12 m of depth: 6/5 of the distance to the middle";
  const auto stays = [&](float u, float v) {
    return StayingInView(camera, later_now(later), later.initial_depth_m)({u, v});
  };
  EXPECT_TRUE(stays(100.0F, 100.0F));
  EXPECT_TRUE(stays(175.0F, 100.0F));
  EXPECT_FALSE(stays(180.0F, 100.0F));
  EXPECT_FALSE(stays(100.0F, 20.0F));
  motion_.speed_mps = 0.0F;
  EXPECT_TRUE(stays(180.0F, 100.0F));
}

/// Looking to the left, on the side where the picture ends: what lies behind leaves, what lies
/// ahead comes nearer. A turn moves all of the picture.
TEST_F(SeedsInMotion, LeaveBehindWhereTheCameraLooksAside) {
  look_left();
  motion_.speed_mps = 10.0F;
  const PinholeCamera<float> camera = wide_camera();
  const SeedParameters later = seeds();
  const auto stays = [&](float u) {
    return StayingInView(camera, later_now(later), later.initial_depth_m)({u, 100.0F});
  };
  EXPECT_FALSE(stays(15.0F)) << "16.7 px of flow";
  EXPECT_TRUE(stays(25.0F));
  EXPECT_TRUE(stays(190.0F));
  motion_.turn_rad = 0.1F;
  EXPECT_TRUE(stays(15.0F)) << "to the left, towards it, by 20 px";
  EXPECT_FALSE(stays(190.0F));
}

TEST_F(SeedsInMotion, ExpectTheCameraOnTheArc) {
  motion_.turn_rad = 0.05F;
  const Rigid<float> later = camera_after(motion_, 2, estimate_.mount);
  const Vector3<float> moved = estimate_.mount.rotation * later.translation;
  EXPECT_NEAR(moved.x(), 0.2F * 0.99875F, 1e-5F);
  EXPECT_NEAR(moved.y(), 0.2F * 0.04998F, 1e-5F);
  const Vector3<float> forward =
      estimate_.mount.rotation * (later.rotation * Vector3<float>::UnitZ());
  EXPECT_NEAR(forward.y(), 0.09983F, 1e-5F);
}

struct EstimateOfAWay {
  GroupIekfSlam<float, 4, 3> slam;
  const GroupIekfSlam<float, 4, 3>& filter() const { return slam; }
};

/// GIVEN a vehicle that remembers where it was, and has moved 5 cm by an odometry of 2 cm a step.
class AWaySinceAKeyframe : public ::testing::Test {
 protected:
  static constexpr LandmarkId kKeyframe = 3;

  AWaySinceAKeyframe() {
    EXPECT_TRUE(ok(estimate_.slam.initialise({}, 1e-8F * Matrix3<float>::Identity())));
    EXPECT_TRUE(ok(estimate_.slam.add_position(kKeyframe)));
    move(0.05F);
  }
  void move(float distance_m) {
    PlanarIncrement<float> step;
    step.distance_m = distance_m;
    step.covariance(0, 0) = 4e-4F;
    step.covariance(1, 1) = 1e-6F;
    EXPECT_TRUE(ok(estimate_.slam.predict(step)));
  }

  EstimateOfAWay estimate_;
};

TEST_F(AWaySinceAKeyframe, IsKnownOnceItIsFourTimesItsSigma) {
  EXPECT_FALSE(way_is_known(estimate_, kKeyframe)) << "5 +- 2 cm";
  move(0.05F);
  EXPECT_FALSE(way_is_known(estimate_, kKeyframe)) << "10 +- 2.8 cm";
  move(0.05F);
  EXPECT_TRUE(way_is_known(estimate_, kKeyframe)) << "15 +- 3.5 cm";
}

TEST_F(AWaySinceAKeyframe, IsUnknownToAVehicleThatHasNotMoved) {
  move(-0.05F);
  EXPECT_FALSE(way_is_known(estimate_, kKeyframe));
}

/// Sideways errors turn the map, they do not scale it.
TEST_F(AWaySinceAKeyframe, IsKnownDespiteLateralSlip) {
  for (int k = 0; k < 3; ++k) move(0.05F);
  ASSERT_TRUE(ok(estimate_.slam.slip_laterally(0.01F)));
  EXPECT_TRUE(way_is_known(estimate_, kKeyframe));
  ASSERT_TRUE(ok(estimate_.slam.widen_pose(0.01F, 0.0F)));
  EXPECT_FALSE(way_is_known(estimate_, kKeyframe));
}

TEST_F(AWaySinceAKeyframe, OfAnotherFilterIsNoConcern) {
  EXPECT_TRUE(way_is_known(estimate_, LandmarkId{99}));
}

}  // namespace
}  // namespace cairn
