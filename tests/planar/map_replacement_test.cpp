// A full map that makes room for a landmark that refers to others.
#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/fixed/fixed_vehicle_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

namespace cairn {
namespace {

constexpr LandmarkId kUnseen = 1;
constexpr LandmarkId kSeen = 2;
constexpr LandmarkId kNew = 9;

/// GIVEN a full map of two landmarks, of which one was not used for long and would make room.
template <class Filter>
class FullMap : public ::testing::Test {
 protected:
  FullMap() {
    PlanarParameters<float> parameters;
    parameters.replace_after = 1;
    EXPECT_TRUE(ok(
        filter_.initialise(PlanarPose<float>(), 1e-4F * Matrix3<float>::Identity(), parameters)));
    EXPECT_TRUE(ok(filter_.add_landmark(kUnseen, {3.0F, 1.0F, 0.5F}, noise_)));
    EXPECT_TRUE(ok(filter_.add_landmark(kSeen, {4.0F, -1.0F, 0.5F}, noise_)));
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(ok(filter_.predict(twist_increment(0.5F, 0.1F, 0.1F, 0.1F, 0.02F))));
      EXPECT_TRUE(ok(filter_.update_height(kSeen, 0.5F, 0.1F, 20.0F)));
      update();
    }
  }

  /// One that counts as an update.
  void update() {
    PinholeCamera<float> camera;
    camera.fx = camera.fy = 250.0F;
    camera.cx = 159.5F;
    camera.cy = 119.5F;
    camera.width = 320;
    camera.height = 240;
    const Rigid<float> ahead{{0.5F, -0.5F, 0.5F, -0.5F}, {0.1F, 0.0F, 1.0F}};
    const int slot = filter_.find(kSeen);
    PixelPrediction<float> expected;
    ASSERT_TRUE(ok(filter_.predict_pixel(slot, camera, ahead, 0.5F, expected)));
    PixelMatch<float> match;
    match.slot = slot;
    match.id = kSeen;
    match.pixel = expected.pixel;
    OnePointRansacParameters ransac;
    ransac.min_inliers = 1;
    filter_.set_ransac(ransac);
    UpdateReport report;
    ASSERT_TRUE(ok(filter_.update_pixels(camera, ahead, 0.5F, &match, 1, random_, report)));
  }
  std::uint64_t hash() const {
    Hash64 sum;
    filter_.hash(sum);
    return sum.value();
  }

  Filter filter_;
  Random random_{1};
  const Matrix3<float> noise_ = 0.01F * Matrix3<float>::Identity();
};

using Filters =
    ::testing::Types<EkfSlam<float, 2, 3>, GroupIekfSlam<float, 2, 3>, FixedVehicleSlam<2>>;
TYPED_TEST_SUITE(FullMap, Filters, );

TYPED_TEST(FullMap, WhatALandmarkRefersToMakesNoRoomForIt) {
  auto& filter = this->filter_;
  const std::uint64_t before = this->hash();
  const Vector3<float> p(5.0F, 0.0F, 0.5F);
  EXPECT_EQ(filter.add_frame_position(kNew, p, this->noise_, kUnseen), Status::kFull);
  EXPECT_EQ(filter.add_framed_landmark(kNew, p, this->noise_, kUnseen, kSeen), Status::kFull);
  EXPECT_EQ(filter.add_framed_landmark(kNew, p, this->noise_, kSeen, kUnseen), Status::kFull);
  const Matrix<float, 3, 2> by_path = Matrix<float, 3, 2>::Zero();
  EXPECT_EQ(filter.add_landmark_on_path(kNew, p, this->noise_, kUnseen, by_path), Status::kFull);
  EXPECT_EQ(this->hash(), before);
  EXPECT_TRUE(ok(filter.add_landmark_on_path(kNew, p, this->noise_, kSeen, by_path)));
  EXPECT_LT(filter.find(kUnseen), 0);
}

}  // namespace
}  // namespace cairn
