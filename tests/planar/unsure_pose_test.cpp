#include <gtest/gtest.h>

#include "cairn/planar/group_iekf_slam.hpp"

namespace cairn {
namespace {

constexpr float kWide = 18.42F;

/// GIVEN a vehicle 60 m from its start, before landmarks ahead of it that it has just seen.
class VehicleFarFromItsStart : public ::testing::Test {
 protected:
  using Filter = GroupIekfSlam<float, 16, 3>;
  static constexpr int kLandmarks = 12;

  VehicleFarFromItsStart() {
    camera_.fx = camera_.fy = 250.0F;
    camera_.cx = 160.0F;
    camera_.cy = 120.0F;
    camera_.width = 320;
    camera_.height = 240;
    Matrix3<float> axes;
    axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    T_vehicle_camera_ = {Quaternion<float>(axes), Vector3<float>(0.2F, 0.0F, 1.0F)};
    PlanarParameters<float> parameters;
    parameters.reacquire_after = 0;
    parameters.gate = kWide;
    parameters.ransac.min_inliers = 2;
    EXPECT_TRUE(ok(filter_.initialise({}, 1e-6F * Matrix3<float>::Identity(), parameters)));
    PlanarIncrement<float> far;
    far.distance_m = 60.0F;
    far.covariance = Vector2<float>(0.01F, 1e-6F).asDiagonal();
    EXPECT_TRUE(ok(filter_.predict(far)));
    for (int i = 0; i < kLandmarks; ++i) {
      const Vector3<float> seen(4.0F + 0.5F * static_cast<float>(i),
                                0.4F * static_cast<float>(i % 5 - 2),
                                0.3F * static_cast<float>(i % 4));
      EXPECT_TRUE(ok(filter_.add_landmark(static_cast<LandmarkId>(i + 1), seen,
                                          1e-4F * Matrix3<float>::Identity())));
    }
  }

  PixelPrediction<float> predict(int slot) const {
    PixelPrediction<float> prediction;
    EXPECT_TRUE(ok(filter_.predict_pixel(slot, camera_, T_vehicle_camera_, 0.8F, prediction)));
    return prediction;
  }
  void turn_unsure(float sigma_m, float sigma_rad) {
    EXPECT_TRUE(ok(filter_.widen_pose(square(sigma_m), square(sigma_rad))));
    static_cast<void>(filter_.recentre());
  }

  PinholeCamera<float> camera_;
  Rigid<float> T_vehicle_camera_;
  Filter filter_;
  Random random_{1};
};

/// An unsure heading turns the vehicle, it does not move it; about the start, 60 m away, it would.
TEST_F(VehicleFarFromItsStart, StaysWhereItIsWhenItsHeadingIsUnsure) {
  const PlanarPose<float> before = filter_.mean_pose();
  const Matrix3<float> known = filter_.pose_covariance();
  EXPECT_FALSE(filter_.recentre()) << "nothing is unsure";
  ASSERT_TRUE(ok(filter_.widen_pose(0.0F, square(0.5F))));
  PixelPrediction<float> expected[kLandmarks];
  for (int i = 0; i < kLandmarks; ++i) expected[i] = predict(i);
  ASSERT_TRUE(filter_.recentre());
  EXPECT_FALSE(filter_.recentre());
  EXPECT_NEAR((filter_.mean_pose().position - before.position).norm(), 0.0F, 1e-5F);
  EXPECT_NEAR((filter_.pose().position - before.position).norm(), 0.0F, 1e-3F);
  const Matrix3<float> covariance = filter_.pose_covariance();
  EXPECT_NEAR(covariance(0, 0), known(0, 0), 1e-3F);
  EXPECT_NEAR(covariance(1, 1), known(1, 1), 5e-3F);
  EXPECT_NEAR(covariance(2, 2), known(2, 2) + square(0.5F), 1e-4F);
  for (int i = 0; i < kLandmarks; ++i) {
    const PixelPrediction<float> now = predict(i);
    EXPECT_NEAR((now.pixel - expected[i].pixel).norm(), 0.0F, 0.02F) << i;
    EXPECT_NEAR((now.covariance - expected[i].covariance).norm() / expected[i].covariance.norm(),
                0.0F, 0.01F)
        << i;
  }
}

/// THEN the update is linear about the place that was recognised, not about odometry's.
TEST_F(VehicleFarFromItsStart, UpdatesWhereItWasRecognised) {
  Filter truth = filter_;
  PlanarIncrement<float> moved;
  moved.distance_m = 0.3F;
  moved.turn_rad = 0.5F;
  moved.covariance = Vector2<float>(1e-6F, 1e-6F).asDiagonal();
  ASSERT_TRUE(ok(truth.predict(moved)));
  PixelMatch<float> matches[kLandmarks];
  int count = 0;
  for (int i = 0; i < kLandmarks; ++i) {
    PixelPrediction<float> seen;
    if (!ok(truth.predict_pixel(i, camera_, T_vehicle_camera_, 0.8F, seen))) continue;
    matches[count].id = static_cast<LandmarkId>(i + 1);
    matches[count++].pixel = seen.pixel;
  }
  turn_unsure(0.5F, 0.5F);
  PlanarPose<float> recognised = truth.mean_pose();
  recognised.position += Vector2<float>(0.05F, -0.05F);
  recognised.heading += 0.02F;
  const Matrix3<float> covariance = filter_.pose_covariance();
  const Filter::Placement before = filter_.place(recognised, 0.25F, 0.01F);
  EXPECT_EQ(filter_.mean_pose().heading, recognised.heading);
  EXPECT_NEAR(filter_.pose_covariance()(2, 2), covariance(2, 2) - 0.25F + 0.01F, 1e-4F);
  filter_.put_back(before);
  EXPECT_EQ(filter_.mean_pose().heading, before.pose.heading);
  EXPECT_NEAR((filter_.pose_covariance() - covariance).norm(), 0.0F, 1e-6F);
  static_cast<void>(filter_.place(recognised, 0.25F, 0.01F));
  UpdateReport report;
  ASSERT_TRUE(
      ok(filter_.update_pixels(camera_, T_vehicle_camera_, 0.8F, matches, count, random_, report)));
  EXPECT_NEAR(filter_.mean_pose().heading, truth.mean_pose().heading, 0.002F);
  EXPECT_NEAR((filter_.mean_pose().position - truth.mean_pose().position).norm(), 0.0F, 0.02F);
}

}  // namespace
}  // namespace cairn
