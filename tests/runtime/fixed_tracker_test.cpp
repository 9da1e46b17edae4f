#include <memory>

#include <gtest/gtest.h>

#include "cairn/planar/fixed/fixed_vehicle_slam.hpp"

#include "vehicle_by_a_wall.hpp"

namespace cairn {
namespace {

/// GIVEN a tracker in fixed point beside the one in float, on the same vehicle.
class FixedTracker : public test::VehicleByAWall {
 protected:
  using Fixed = VehicleTracker<DefaultConfig, FixedVehicleSlam<DefaultConfig::kMaxLandmarks>>;

  FixedTracker() : VehicleByAWall(0.02F, 0.01F) {
    Fixed::Start start;
    start.covariance = 1e-8F * Matrix3<float>::Identity();
    Fixed::Parameters parameters;
    parameters.odometry = {0.02F, 0.01F, 0.5F, kStepS};
    EXPECT_TRUE(ok(
        fixed_->initialise(tracker_->camera(), tracker_->T_vehicle_camera(), start, parameters)));
  }
  void step_both(const Image& image) {
    OdometrySample sample;
    sample.t_us = frame_ * kStepUs;
    sample.speed_mps = frame_ == 0 ? 0.0F : static_cast<float>(kStep / (1e-6 * kStepUs));
    EXPECT_TRUE(ok(fixed_->add_odometry(sample)));
    EXPECT_TRUE(ok(fixed_->process_frame(test::view(image, test::small_camera()), sample.t_us,
                                         TickSource{}, own_)));
    step(image, kStep);
  }

  std::unique_ptr<Fixed> fixed_ = std::make_unique<Fixed>();
  FrameReport own_;
};

TEST_F(FixedTracker, TracksAsFloatDoesAndSaturatesNowhere) {
  constexpr int kFrames = 90;
  for (int k = 0; k < kFrames; ++k) {
    step_both(picture(k));
    EXPECT_EQ(own_.state, report_.state) << k;
    EXPECT_NEAR(own_.inliers, report_.inliers, 3) << k;
    const Vector3<float> away = own_.T_map_camera.translation - report_.T_map_camera.translation;
    EXPECT_LT(away.norm(), 0.004F) << k;
  }
  EXPECT_EQ(own_.state, TrackingState::kTracking);
  EXPECT_GE(own_.inliers, 8);
  EXPECT_EQ(fixed_->frames().saturations(), 0U);
}

}  // namespace
}  // namespace cairn
