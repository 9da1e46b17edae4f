#include "cairn/tracking/planar_pose_search.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

/// GIVEN a vehicle whose camera looks ahead from 1 m above the floor, and a prior that is off by
/// 0.15 rad and 0.3 m.
class LostVehicle : public ::testing::Test {
 protected:
  LostVehicle() {
    camera_.fx = camera_.fy = 500.0F;
    camera_.cx = 319.5F;
    camera_.cy = 239.5F;
    camera_.width = 640;
    camera_.height = 480;
    T_vehicle_camera_ = {{0.5F, -0.5F, 0.5F, -0.5F}, {0.1F, 0.0F, 1.0F}};
    truth_.position = {2.0F, -1.0F};
    truth_.heading = 0.4F;
    prior_.pose.position = {2.25F, -1.15F};
    prior_.pose.heading = 0.55F;
    prior_.covariance = Vector3<float>(0.04F, 0.04F, 0.01F).asDiagonal();
  }

  float uniform(float low, float high) {
    return low + (high - low) * static_cast<float>(random_.below(65536)) / 65535.0F;
  }
  PlanarView view() const { return {camera_, T_vehicle_camera_, sigma_tilt_rad_}; }

  Vector3<float> point_ahead() {
    const Vector3<float> p_vehicle{uniform(3.0F, 8.0F), uniform(-2.0F, 2.0F), uniform(0.0F, 2.5F)};
    return on_floor(truth_) * p_vehicle;
  }
  void add_right() {
    PlanarSighting& s = sightings_[count_++];
    s.p_map = point_ahead();
    Matrix<float, 2, 3> jacobian;
    ASSERT_TRUE(ok(view().predict(truth_, s.p_map, s.pixel, jacobian)));
    s.pixel += Vector2<float>{uniform(-1.0F, 1.0F), uniform(-1.0F, 1.0F)};
  }
  void add_wrong() {
    PlanarSighting& s = sightings_[count_++];
    s.p_map = point_ahead();
    s.pixel = {uniform(0.0F, 639.0F), uniform(0.0F, 479.0F)};
  }
  Status search(PlanarPose<float>& pose) {
    return find_planar_pose(view(), prior_, sightings_, count_, PlanarPoseOptions{}, pose,
                            inlier_count_);
  }

  PinholeCamera<float> camera_;
  Rigid<float> T_vehicle_camera_;
  float sigma_tilt_rad_ = 0.0F;
  PlanarPose<float> truth_;
  PlanarPrior prior_;
  PlanarSighting sightings_[PlanarPoseOptions::kMaxSightings];
  int count_ = 0;
  int inlier_count_ = -1;
  Random random_{7};
};

/// Sightings that a tilt of the body has moved together are no outliers where that may be.
TEST_F(LostVehicle, AllowsTheTiltThatIsUnknown) {
  for (int i = 0; i < 12; ++i) add_right();
  for (int i = 0; i < count_; ++i) {
    sightings_[i].pixel.y() += 8.0F;
    sightings_[i].sigma_px = 6.0F;
  }
  PlanarPose<float> pose;
  EXPECT_EQ(search(pose), Status::kNoConsensus);
  sigma_tilt_rad_ = 0.01F;
  EXPECT_EQ(search(pose), Status::kOk);
  EXPECT_NEAR(pose.heading, truth_.heading, 0.02F);
}

TEST_F(LostVehicle, JacobianIsTheSlopeOfThePixel) {
  constexpr float kStep = 1e-3F;
  const Vector3<float> p = point_ahead();
  Vector2<float> pixel;
  Matrix<float, 2, 3> jacobian;
  ASSERT_TRUE(ok(view().predict(truth_, p, pixel, jacobian)));
  for (int i = 0; i < 3; ++i) {
    Vector2<float> ends[2];
    for (int side = 0; side < 2; ++side) {
      PlanarPose<float> moved = truth_;
      const float step = side == 0 ? -kStep : kStep;
      if (i < 2) moved.position[i] += step;
      if (i == 2) moved.heading += step;
      Matrix<float, 2, 3> unused;
      ASSERT_TRUE(ok(view().predict(moved, p, ends[side], unused)));
    }
    const Vector2<float> slope = (ends[1] - ends[0]) / (2.0F * kStep);
    EXPECT_LT((slope - jacobian.col(i)).norm(), 0.01F * (1.0F + slope.norm()));
  }
}

/// Two of three sightings are wrong. Over 4,000 such scenes 90.4 % are claimed, and 98.0 % of the
/// claims are within 0.15 m and 0.03 rad: a wrong sighting that passes by the right pose can pull
/// it away.
TEST_F(LostVehicle, SixRightOfEighteenSightingsTellThePose) {
  constexpr int kScenes = 1000;
  int claimed = 0;
  int right = 0;
  for (int scene = 0; scene < kScenes; ++scene) {
    count_ = 0;
    for (int i = 0; i < 6; ++i) add_right();
    for (int i = 0; i < 12; ++i) add_wrong();
    PlanarPose<float> pose;
    if (!ok(search(pose))) continue;
    ++claimed;
    const bool near = (pose.position - truth_.position).norm() < 0.15F &&
                      std::abs(pose.heading - truth_.heading) < 0.03F;
    right += near ? 1 : 0;
  }
  EXPECT_GE(claimed, kScenes * 87 / 100);
  EXPECT_GE(right, claimed * 96 / 100);
}

TEST_F(LostVehicle, WrongSightingsRarelyAgree) {
  int claimed = 0;
  for (int scene = 0; scene < 50; ++scene) {
    count_ = 0;
    for (int i = 0; i < 18; ++i) add_wrong();
    PlanarPose<float> pose;
    claimed += ok(search(pose)) ? 1 : 0;
  }
  EXPECT_LE(claimed, 5);  // what is left is for the look at the next image
}

TEST_F(LostVehicle, RefusesWhatItCannotUse) {
  for (int i = 0; i < 6; ++i) add_right();
  PlanarPose<float> pose;
  pose.heading = 42.0F;
  count_ = PlanarPoseOptions::kMaxSightings + 1;
  EXPECT_EQ(search(pose), Status::kInvalidArgument);
  count_ = 3;
  EXPECT_EQ(search(pose), Status::kNoConsensus);
  count_ = 6;
  prior_.covariance(2, 2) = 0.0F;
  EXPECT_EQ(search(pose), Status::kSingular);
  EXPECT_EQ(pose.heading, 42.0F);
  EXPECT_EQ(inlier_count_, -1);
}

/// A vehicle that was blind for seconds: 0.5 rad and 0.6 m off, and as unsure.
class BlindVehicle : public LostVehicle {
 protected:
  BlindVehicle() {
    prior_.pose.position = {2.5F, -1.3F};
    prior_.pose.heading = 0.9F;
    prior_.covariance = Vector3<float>(0.3F, 0.3F, 0.3F).asDiagonal();
  }
  Status agree(PlanarPose<float>& pose) {
    return find_planar_consensus(view(), prior_, sightings_, count_, PlanarConsensusOptions{}, pose,
                                 inliers_, inlier_count_);
  }
  bool inliers_[PlanarPoseOptions::kMaxSightings] = {};
};

TEST_F(BlindVehicle, IsFoundWhereMostSightingsAgree) {
  for (int trial = 0; trial < 50; ++trial) {
    count_ = 0;
    for (int i = 0; i < 9; ++i) {
      add_right();
      if (i % 3 == 2) add_wrong();
    }
    PlanarPose<float> pose;
    EXPECT_EQ(agree(pose), Status::kOk) << trial;
    EXPECT_GE(inlier_count_, 9);
    EXPECT_NEAR(pose.heading, truth_.heading, 0.01F) << trial;
    EXPECT_NEAR((pose.position - truth_.position).norm(), 0.0F, 0.05F) << trial;
    for (int i = 0; i < 3; ++i) EXPECT_TRUE(inliers_[i]) << "nothing wrong before them";
  }
}

/// False sightings lie anywhere in windows that are as wide as what is searched.
TEST_F(BlindVehicle, TakesNoAgreementThatChanceGivesForItsPlace) {
  PlanarPose<float> pose;
  const PlanarPose<float> before = pose;
  int taken = 0;
  for (int trial = 0; trial < 300; ++trial) {
    count_ = 0;
    for (int i = 0; i < 12; ++i) {
      add_wrong();
      PlanarSighting& s = sightings_[count_ - 1];
      Matrix<float, 2, 3> jacobian;
      ASSERT_TRUE(ok(view().predict(truth_, s.p_map, s.pixel, jacobian)));
      s.pixel += Vector2<float>{uniform(-25.0F, 25.0F), uniform(-25.0F, 25.0F)};
    }
    taken += ok(agree(pose)) ? 1 : 0;
  }
  EXPECT_EQ(taken, 0);
  EXPECT_EQ(pose.heading, before.heading) << "unchanged on an error";
}

TEST_F(BlindVehicle, RefusesWhatItCannotUse) {
  PlanarPose<float> pose;
  for (int i = 0; i < 6; ++i) add_right();
  count_ = PlanarPoseOptions::kMaxSightings + 1;
  EXPECT_EQ(agree(pose), Status::kInvalidArgument);
  count_ = 1;
  EXPECT_EQ(agree(pose), Status::kNoConsensus);
  count_ = 6;
  prior_.covariance.setZero();
  EXPECT_EQ(agree(pose), Status::kSingular);
}

}  // namespace
}  // namespace cairn
