#include <cmath>

#include "vehicle_by_a_wall.hpp"

namespace cairn {
namespace {

/// GIVEN a vehicle that has mapped the wall beside it for 1.3 s.
class VehicleWithDoubtfulOdometry : public test::VehicleByAWall {
 protected:
  static constexpr int kBefore = 40;

  VehicleWithDoubtfulOdometry() : VehicleByAWall(0.05F, 0.1F) {
    for (int k = 0; k < kBefore; ++k) step(picture(k), k == 0 ? 0.0 : kStep);
    EXPECT_EQ(report_.state, TrackingState::kTracking);
  }

  /// Drives on for `frames`, while odometry says `share` of the truth, or nothing.
  void drive(int frames, const float* share) {
    for (int k = 0; k < frames; ++k) {
      OdometrySample sample;
      sample.t_us = frame_ * kStepUs;
      if (share != nullptr) {
        sample.speed_mps = *share * static_cast<float>(kStep / (1e-6 * kStepUs));
        static_cast<void>(tracker_->add_odometry(sample));
      }
      const int place = frame_ + ahead_;
      static_cast<void>(tracker_->process_frame(test::view(picture(place), test::small_camera()),
                                                sample.t_us, TickSource{}, report_));
      ++frame_;
      const double error =
          static_cast<double>(tracker_->filter().mean_pose().position.x()) - place * kStep;
      const double sigma = std::sqrt(static_cast<double>(tracker_->pose_covariance()(0, 0)));
      if (report_.state == TrackingState::kTracking) {
        EXPECT_LT(std::abs(error), 3.9 * sigma) << frame_;
      }
      error_m_ = std::abs(error);
    }
  }

  int ahead_ = 0;  ///< steps that it made beside those of the frames
  double error_m_ = 0.0;
};

TEST_F(VehicleWithDoubtfulOdometry, IsUncertainWhileItsOdometryIsContradicted) {
  const float right = 1.0F;
  for (const float share : {0.0F, 3.6F}) {
    drive(30, &share);
    EXPECT_EQ(report_.state, TrackingState::kUncertain) << share;
    EXPECT_LT(error_m_, 0.1) << share;
    drive(30, &right);
    EXPECT_EQ(report_.state, TrackingState::kTracking) << share;
  }
}

TEST_F(VehicleWithDoubtfulOdometry, IsUncertainWhileItsOdometryIsSilent) {
  drive(20, nullptr);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  drive(40, nullptr);
  EXPECT_EQ(report_.state, TrackingState::kUncertain);
  EXPECT_EQ(report_.status, Status::kTimeGap);
  EXPECT_LT(error_m_, 0.1);
  const float right = 1.0F;
  drive(5, &right);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

/// Neither pictures nor odometry come for a while, in which it drives twice as fast.
TEST_F(VehicleWithDoubtfulOdometry, IsAsUnsureAsAGapLeavesItAndMapsOn) {
  constexpr int kMissing[] = {8, 12};  // frames: 0.27 and 0.4 s
  const float right = 1.0F;
  for (const int missing : kMissing) {
    frame_ += missing;
    ahead_ += missing;
    drive(45, &right);
    EXPECT_EQ(report_.state, TrackingState::kTracking) << missing;
  }
}

}  // namespace
}  // namespace cairn
