#include <cmath>

#include "vehicle_by_a_wall.hpp"

namespace cairn {
namespace {

/// GIVEN a vehicle that has tracked the wall for a second and a half.
class VehicleWithAClock : public test::VehicleByAWall {
 protected:
  static constexpr int kTracked = 45;
  static constexpr std::int64_t kHourUs = 3600000000;

  VehicleWithAClock() : VehicleByAWall(0.05F, 0.02F) {
    for (int k = 0; k < kTracked; ++k) step(picture(k), k == 0 ? 0.0 : kStep);
    EXPECT_EQ(report_.state, TrackingState::kTracking);
  }
  Status odometry(std::int64_t t_us) {
    OdometrySample sample;
    sample.t_us = t_us;
    sample.speed_mps = static_cast<float>(kStep / (1e-6 * kStepUs));
    return tracker_->add_odometry(sample);
  }
  Status frame(int shown, std::int64_t t_us) {
    return tracker_->process_frame(test::view(picture(shown), test::small_camera()), t_us,
                                   TickSource{}, report_);
  }
  /// Frame `shown` and its odometry, with all stamps `late_us` later than they should be.
  Status both(int shown, std::int64_t late_us) {
    static_cast<void>(odometry(shown * kStepUs + late_us));
    return frame(shown, shown * kStepUs + late_us);
  }
  float sigma_x() const { return std::sqrt(tracker_->filter().pose_covariance()(0, 0)); }
  float x() const { return tracker_->filter().mean_pose().position.x(); }
};

TEST_F(VehicleWithAClock, LosesOneInputToOneWrongStamp) {
  const float before = x();
  EXPECT_EQ(odometry(kTracked * kStepUs + kHourUs), Status::kTimeGap);
  EXPECT_EQ(frame(kTracked, kTracked * kStepUs), Status::kOk);
  EXPECT_EQ(both(kTracked + 1, 0), Status::kOk);
  EXPECT_EQ(frame(kTracked + 2, kTracked * kStepUs - kHourUs), Status::kTimeBackwards);
  EXPECT_EQ(both(kTracked + 3, 0), Status::kOk);
  EXPECT_EQ(tracker_->health().time_errors, 2U);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_NEAR(x() - before, 4 * kStep, 0.01);
}

TEST_F(VehicleWithAClock, GoesOnWithAClockThatWasSetBack) {
  EXPECT_EQ(odometry(kTracked * kStepUs - kHourUs), Status::kTimeBackwards);
  EXPECT_EQ(frame(kTracked, kTracked * kStepUs - kHourUs), Status::kTimeGap)
      << "tracked after a gap of unknown length";
  EXPECT_EQ(report_.t_us, kTracked * kStepUs - kHourUs);
  // In the windows of so unsure a pose half of the matches are false: one frame may not suffice.
  static_cast<void>(both(kTracked + 1, -kHourUs));
  for (int k = 2; k < 6; ++k) EXPECT_EQ(both(kTracked + k, -kHourUs), Status::kOk) << k;
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_NEAR(x(), (kTracked + 5) * kStep, 0.02) << "where it is, not a tile beside";
}

TEST_F(VehicleWithAClock, TakesNoOtherClockFromSamplesThatAreRefused) {
  const float at = x();
  const float sigma = sigma_x();
  for (int k = 0; k < 8; ++k) {
    OdometrySample sample;
    sample.t_us = (kTracked + k) * kStepUs - kHourUs;
    sample.speed_mps = k % 2 == 0 ? std::nanf("") : 1e6F;
    EXPECT_EQ(tracker_->add_odometry(sample),
              k % 2 == 0 ? Status::kNonFiniteInput : Status::kInvalidArgument);
  }
  EXPECT_EQ(x(), at);
  EXPECT_EQ(sigma_x(), sigma);
  EXPECT_EQ(both(kTracked, 0), Status::kOk);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

/// Neither frames nor odometry come for three seconds, in which the vehicle may have done anything.
TEST_F(VehicleWithAClock, IsUncertainAfterAGap) {
  constexpr std::int64_t kGapUs = 3000000;
  const float before = sigma_x();
  EXPECT_EQ(odometry(kTracked * kStepUs + kGapUs), Status::kTimeGap);
  // The camera sees another place than the one where it was.
  EXPECT_EQ(frame(0, kTracked * kStepUs + kGapUs), Status::kLost);
  EXPECT_EQ(report_.state, TrackingState::kLost);
  EXPECT_GT(sigma_x(), before + 1.0F);
  EXPECT_NEAR(tracker_->health().frame_gaps, 90U, 2U);
}

/// It stood still in the gap, against what odometry says before and after it.
TEST_F(VehicleWithAClock, FindsItsPlaceAfterAGapInWhichItStood) {
  constexpr std::int64_t kGapUs = 1500000;
  static_cast<void>(both(kTracked, kGapUs));
  EXPECT_GT(sigma_x(), 0.7F);
  for (int k = 1; k < 20; ++k) static_cast<void>(both(kTracked + k, kGapUs));
  for (int k = 20; k < 25; ++k) EXPECT_EQ(both(kTracked + k, kGapUs), Status::kOk);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_NEAR(x(), (kTracked + 24) * kStep, 0.05);
  EXPECT_LT(sigma_x(), 0.1F);
}

/// A camera that hangs hands out its last picture again while the vehicle drives on.
TEST_F(VehicleWithAClock, MeasuresNothingInAPictureThatItHasSeen) {
  const float before = x();
  const float sigma = sigma_x();
  constexpr int kHung = 4;
  for (int k = 0; k < kHung; ++k) {
    static_cast<void>(odometry((kTracked + k) * kStepUs));
    EXPECT_EQ(frame(kTracked - 1, (kTracked + k) * kStepUs), Status::kRepeatedImage);
    EXPECT_EQ(report_.state, TrackingState::kUncertain);
    EXPECT_EQ(report_.searched, 0);
  }
  EXPECT_NEAR(x() - before, kHung * kStep, 0.01) << "odometry's motion";
  EXPECT_GT(sigma_x(), sigma);
  EXPECT_EQ(tracker_->health().repeated_images, static_cast<std::uint32_t>(kHung));
  EXPECT_EQ(both(kTracked + kHung, 0), Status::kOk);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

TEST_F(VehicleWithAClock, RefusesAnImageOfAnotherSizeAndCountsIt) {
  const ImageView narrow{picture(0).data(), 319, 240, 320};
  EXPECT_EQ(tracker_->process_frame(narrow, kTracked * kStepUs, TickSource{}, report_),
            Status::kInvalidArgument);
  EXPECT_EQ(tracker_->health().images_refused, 1U);
}

}  // namespace
}  // namespace cairn
