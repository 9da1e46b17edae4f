#include "cairn/tracking/map_alignment.hpp"

#include <type_traits>

#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

#include "vga_camera.hpp"

namespace cairn {
namespace {

constexpr int kCount = 10;

/// Looking ahead, 0.4 m above the floor.
Rigid<float> mounting() {
  return {Quaternion<float>(test::looking_ahead<float>()), Vector3<float>(0.1F, 0.0F, 0.4F)};
}

/// Landmarks of the map, in its coordinates: ahead of the vehicle at `pose`.
Vector3<float> landmark(const PlanarPose<float>& pose, int k) {
  const auto i = static_cast<float>(k);
  return on_floor(pose) *
         Vector3<float>(3.0F + 0.7F * i, (k % 2 == 0 ? 0.25F : -0.2F) * (3.0F + i), 0.2F * i);
}

Rigid<float> vehicle_in(const PlanarPose<float>& frame, const PlanarPose<float>& pose) {
  return on_floor(frame).inverse() * on_floor(pose);
}

template <class Filter>
class MapAlignmentTest : public testing::Test {
 protected:
  void SetUp() override {
    pose_.position = {12.0F, -7.0F};
    pose_.heading = 0.8F;
    covariance_ = Vector3<float>(0.04F, 0.02F, square(0.04F)).asDiagonal();
    ASSERT_TRUE(ok(filter_.initialise(pose_, covariance_, PlanarParameters<float>{})));
    ASSERT_TRUE(ok(alignment_.begin(filter_, next_id_, covariance_, square(0.02F))));
  }

  void add_landmarks(int first, int last) {
    const Matrix3<float> own = square(0.01F) * Matrix3<float>::Identity();
    for (int k = first; k < last; ++k) {
      ASSERT_TRUE(ok(alignment_.add_landmark(filter_, static_cast<LandmarkId>(100 + k),
                                             landmark(pose_, k), own)));
    }
  }

  /// Pixels of the landmarks [first, last) where the map lies as `truth` says.
  int see(const PlanarPose<float>& truth, int first, int last) {
    PixelMatch<float> matches[kCount];
    const Rigid<float> T_camera_map =
        (on_floor(filter_truth_) * mounting()).inverse() * on_floor(truth);
    for (int k = first; k < last; ++k) {
      PixelMatch<float>& match = matches[k - first];
      match.id = static_cast<LandmarkId>(100 + k);
      match.slot = filter_.find(match.id);
      EXPECT_TRUE(
          ok(test::vga_camera<float>().project(T_camera_map * landmark(pose_, k), match.pixel)));
    }
    Random random(1);
    UpdateReport report;
    EXPECT_TRUE(ok(filter_.update_pixels(test::vga_camera<float>(), mounting(), 0.5F, matches,
                                         last - first, random, report)));
    return report.low_innovation + report.high_innovation;
  }

  Filter filter_;
  MapAlignment<Filter> alignment_;
  LandmarkId next_id_ = 1;
  PlanarPose<float> pose_;          ///< of the vehicle, as the filter starts
  PlanarPose<float> filter_truth_;  ///< where it is
  Matrix3<float> covariance_;
};

using Filters = testing::Types<EkfSlam<float, 24, 3>, GroupIekfSlam<float, 24, 3>>;
TYPED_TEST_SUITE(MapAlignmentTest, Filters, );

TYPED_TEST(MapAlignmentTest, IsTheWorldUntilTheMapIsSeen) {
  this->add_landmarks(0, kCount);
  EXPECT_LT(this->alignment_.T_world_map(this->filter_).translation.norm(), 1e-5F);
  const int slot = this->filter_.find(105);
  EXPECT_LT((this->filter_.mean_landmark(slot) - landmark(this->pose_, 5)).norm(), 1e-5F);
}

/// The map is turned and shifted: the pose in the map follows the landmarks, and the pose in the
/// world is as unsure as it was, however many landmarks are measured.
TYPED_TEST(MapAlignmentTest, DeterminesThePoseInTheMapAndNotInTheWorld) {
  this->filter_truth_ = this->pose_;
  this->add_landmarks(0, kCount);
  PlanarPose<float> map;  // turned about the vehicle by 0.03 rad, then shifted
  map.heading = 0.03F;
  const Vector3<float> vehicle = on_floor(this->pose_).translation;
  const Vector3<float> turned = on_floor(map) * vehicle;
  map.position = (vehicle - turned).template head<2>() + Vector2<float>(0.1F, -0.06F);
  for (int k = 0; k < 12; ++k) ASSERT_GE(this->see(map, 0, kCount), kCount / 2) << k;

  const Rigid<float> T_map_vehicle =
      this->alignment_.T_world_map(this->filter_).inverse() * on_floor(this->filter_.mean_pose());
  const Rigid<float> error = vehicle_in(map, this->pose_).inverse() * T_map_vehicle;
  EXPECT_LT(error.translation.norm(), 0.015F);
  EXPECT_LT(rotation_log(error.rotation).norm(), 0.003F);

  const Matrix3<float> left = this->filter_.pose_covariance();
  for (int i = 0; i < 3; ++i) {
    EXPECT_GT(left(i, i), 0.98F * this->covariance_(i, i)) << i;
    EXPECT_LT(left(i, i), 1.01F * this->covariance_(i, i)) << i;
  }
  const Matrix3<float> in_map = this->alignment_.pose_covariance(this->filter_);
  EXPECT_LT(in_map(0, 0) + in_map(1, 1), square(0.03F));
  EXPECT_LT(in_map(2, 2), square(0.006F));
  EXPECT_GT(in_map(0, 0) + in_map(1, 1), square(0.002F));
}

/// As unsure as it was begun, in the map's axes.
TYPED_TEST(MapAlignmentTest, KnowsThePoseInTheMapAsItBegan) {
  const Matrix3<float> in_map = this->alignment_.pose_covariance(this->filter_);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(in_map(i, i), this->covariance_(i, i), 0.01F * this->covariance_(i, i)) << i;
  }
  EXPECT_EQ(this->alignment_.recognised_at(), this->pose_.position);
}

/// Later landmarks enter with the alignment that the first ones determined.
TYPED_TEST(MapAlignmentTest, PlacesLaterLandmarksByTheAlignmentOfEarlierOnes) {
  this->filter_truth_ = this->pose_;
  this->add_landmarks(0, 6);
  PlanarPose<float> map;
  map.position = {0.15F, 0.1F};
  for (int k = 0; k < 12; ++k) ASSERT_GE(this->see(map, 0, 6), 3) << k;
  this->add_landmarks(6, kCount);
  PixelPrediction<float> prediction;
  for (int k = 6; k < kCount; ++k) {
    const int slot = this->filter_.find(static_cast<LandmarkId>(100 + k));
    ASSERT_TRUE(ok(this->filter_.predict_pixel(slot, test::vga_camera<float>(), mounting(), 0.5F,
                                               prediction)));
    Vector2<float> pixel;
    ASSERT_TRUE(ok(test::vga_camera<float>().project(
        (on_floor(this->pose_) * mounting()).inverse() * (on_floor(map) * landmark(this->pose_, k)),
        pixel)));
    const Vector2<float> off = pixel - prediction.pixel;
    EXPECT_LT(off.dot(prediction.covariance.inverse() * off), 9.21F) << k;
    EXPECT_LT(prediction.covariance(0, 0), square(8.0F)) << k;
  }
}

/// Offset and turn about the vehicle: near it landmarks get the variance of the offset, far from it
/// also that of the turn.
TYPED_TEST(MapAlignmentTest, DriftsWithTheDistanceTravelled) {
  MapDrift drift;
  drift.position_m = 0.1F;
  drift.heading_rad = 0.02F;
  const int origin = this->filter_.find(1);
  const Matrix3<float> before = this->filter_.landmark_covariance(origin);
  this->alignment_.add_drift(this->filter_, drift);
  EXPECT_NEAR(this->filter_.landmark_covariance(origin)(0, 0), before(0, 0), 1e-6F);
  PlanarIncrement<float> step;
  step.distance_m = 4.0F;
  ASSERT_TRUE(ok(this->filter_.predict(step)));
  this->alignment_.add_drift(this->filter_, drift);
  const Matrix3<float> grown = this->filter_.landmark_covariance(origin) - before;
  const Vector2<float> ahead(cos(this->pose_.heading), sin(this->pose_.heading));
  const Vector2<float> left(-ahead.y(), ahead.x());
  const Matrix2<float> in_plane = grown.template topLeftCorner<2, 2>();
  EXPECT_NEAR(ahead.dot(in_plane * ahead), 4.0F * 0.01F, 2e-3F);
  EXPECT_NEAR(left.dot(in_plane * left), 4.0F * (0.01F + square(4.0F * 0.02F)), 2e-3F);
}

TYPED_TEST(MapAlignmentTest, RefusesWhatItCannotUseAndStaysAsItWas) {
  this->add_landmarks(0, kCount);
  Hash64 before;
  this->filter_.hash(before);
  const Matrix3<float> own = Matrix3<float>::Identity();
  EXPECT_EQ(this->alignment_.add_landmark(this->filter_, 105, Vector3<float>::Zero(), own),
            Status::kDuplicate);
  EXPECT_EQ(this->alignment_.add_landmark(this->filter_, 300, Vector3<float>::Zero(), -own),
            Status::kInvalidArgument);
  EXPECT_EQ(this->filter_.add_framed_landmark(300, Vector3<float>::Zero(), own, 1, 77),
            Status::kNotFound);
  EXPECT_EQ(this->filter_.add_framed_landmark(300, Vector3<float>::Zero(), own, 1, 1),
            Status::kInvalidArgument);
  EXPECT_EQ(this->filter_.widen_frame(1, 77, 0.1F, 0.1F), Status::kNotFound);
  EXPECT_EQ(this->filter_.widen_frame(1, 2, -0.1F, 0.1F), Status::kInvalidArgument);
  Hash64 after;
  this->filter_.hash(after);
  EXPECT_EQ(before.value(), after.value());
}

/// A filter with one free slot cannot hold the frame's two.
TYPED_TEST(MapAlignmentTest, DoesNotBeginByHalves) {
  TypeParam filter;
  MapAlignment<TypeParam> frame;
  LandmarkId next_id = 1;
  ASSERT_TRUE(ok(filter.initialise(this->pose_, this->covariance_, PlanarParameters<float>{})));
  for (; next_id < TypeParam::kMaxLandmarks; ++next_id)
    ASSERT_TRUE(ok(filter.add_position(next_id)));
  EXPECT_EQ(frame.begin(filter, next_id, this->covariance_, 1e-4F), Status::kFull);
  EXPECT_FALSE(frame.estimated(filter));
  EXPECT_EQ(filter.landmark_count(), TypeParam::kMaxLandmarks - 1);
  EXPECT_EQ(next_id, static_cast<LandmarkId>(TypeParam::kMaxLandmarks));
}

}  // namespace
}  // namespace cairn
