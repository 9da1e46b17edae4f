#include <algorithm>
#include <cmath>

#include "vehicle_by_a_wall.hpp"

namespace cairn {
namespace {

/// GIVEN a vehicle that drove along a wall, which its camera looks at, and then stands, while its
/// gyroscope still reports a turn that does not happen, and the camera shows something else.
class VehicleWithoutSight : public test::VehicleByAWall {
 protected:
  static constexpr int kDriven = 60;
  static constexpr int kBlind = 30;
  static constexpr float kFalseTurn = 0.3F;  // rad/s: 0.3 rad, or 75 px, while blind

  VehicleWithoutSight() : VehicleByAWall(0.02F, 0.6F) {
    for (int k = 0; k < kDriven; ++k) step(picture(k), kStep);
    EXPECT_EQ(report_.state, TrackingState::kTracking);
    EXPECT_GE(tracker_->library().size(), 12);
  }

  void stand_before(const Image& image, int frames, float turn) {
    for (int k = 0; k < frames; ++k) {
      step(image, 0.0, turn);
      relocalised_ = relocalised_ || report_.relocalised;
    }
  }

  static constexpr double kDistance_m = kStep * (kDriven - 1);
  bool relocalised_ = false;
};

TEST_F(VehicleWithoutSight, FindsItsPlaceInTheLibraryWhenThePictureIsBack) {
  stand_before(Image(320 * 240, 0), kBlind, kFalseTurn);
  EXPECT_NE(report_.state, TrackingState::kTracking);
  EXPECT_GT(tracker_->filter().mean_pose().heading, 0.12F);
  stand_before(picture(kDriven - 1), 10, 0.0F);
  EXPECT_TRUE(relocalised_);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_EQ(tracker_->health().relocalisations, 1U);
  const PlanarPose<float> pose = tracker_->filter().mean_pose();
  const Matrix3<float> c = tracker_->filter().pose_covariance();
  // A flat wall determines heading and distance only as far as the filter's covariance says.
  EXPECT_LT(std::abs(pose.heading), 3.0F * std::sqrt(c(2, 2)));
  EXPECT_LT(std::sqrt(c(2, 2)), 0.08F);
  EXPECT_NEAR(pose.position.x(), static_cast<float>(kDistance_m), 0.05F);
  EXPECT_NEAR(pose.position.y(), 0.0F, 0.05F);
}

TEST_F(VehicleWithoutSight, KeepsTheLandmarksItCouldNotSee) {
  const int before = tracker_->filter().landmark_count();
  const std::uint32_t removed = tracker_->health().landmarks_removed;
  stand_before(Image(320 * 240, 0), kBlind, kFalseTurn);
  EXPECT_GE(tracker_->filter().landmark_count(), before - 8);  // remembered positions may end
  EXPECT_EQ(tracker_->health().landmarks_removed, removed);
}

/// The picture of a place where the vehicle cannot be: the start of the drive, while odometry and
/// its noise leave a few centimetres.
TEST_F(VehicleWithoutSight, RefusesAPlaceWhereItCannotBe) {
  stand_before(picture(0), kBlind, 0.0F);
  EXPECT_FALSE(relocalised_);
  EXPECT_EQ(tracker_->health().relocalisations, 0U);
  EXPECT_GE(tracker_->health().false_relocalisations_refused, 1U);  // it knew the place
  const PlanarPose<float> pose = tracker_->filter().mean_pose();
  EXPECT_NEAR(pose.position.x(), static_cast<float>(kDistance_m), 0.2F);
  stand_before(picture(kDriven - 1), 10, 0.0F);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_NEAR(tracker_->filter().mean_pose().position.x(), static_cast<float>(kDistance_m), 0.05F);
}

/// Going through such an image would take all of a frame's work, for nothing.
TEST_F(VehicleWithoutSight, SeesSoonThatNoiseIsNoPlace) {
  Random random(5);
  int most_work = 0;
  for (int k = 0; k < kBlind; ++k) {
    Image noise(320 * 240);
    for (std::uint8_t& grey : noise) grey = static_cast<std::uint8_t>(random.next() >> 24U);
    stand_before(noise, 1, 0.0F);
    if (k > 6) most_work = std::max(most_work, report_.work);
  }
  EXPECT_FALSE(relocalised_);
  // Searches come on top, so that a frame that goes through the image takes more.
  EXPECT_LT(most_work, Vehicle::Parameters{}.map_reuse.relocalisation.engine.max_capture_work);
  stand_before(picture(kDriven - 1), 10, 0.0F);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

}  // namespace
}  // namespace cairn
