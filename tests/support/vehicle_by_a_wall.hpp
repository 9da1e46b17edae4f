#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"

#include "plane_scene.hpp"

namespace cairn::test {

/// GIVEN a vehicle whose camera looks at a wall 2 m to the left, along which it drives.
class VehicleByAWall : public ::testing::Test {
 protected:
  using Filter = GroupIekfSlam<float, DefaultConfig::kMaxLandmarks, 3>;
  using Vehicle = VehicleTracker<DefaultConfig, Filter>;
  using Image = std::vector<std::uint8_t>;

  static constexpr double kStep = 0.02;  ///< m a frame
  static constexpr std::int64_t kStepUs = 33333;
  static constexpr float kStepS = 0.033333F;

  /// Noise of the odometry: m/s and rad a sample.
  VehicleByAWall(float sigma_speed_mps, float sigma_turn) {
    const Rigid<float> T_vehicle_camera{{0.70710678F, -0.70710678F, 0.0F, 0.0F},
                                        {0.0F, 0.0F, 1.0F}};
    Vehicle::Start start;
    start.covariance = 1e-8F * Matrix3<float>::Identity();
    Vehicle::Parameters parameters;
    parameters.odometry = {sigma_speed_mps, sigma_turn, 0.5F, kStepS};
    EXPECT_TRUE(
        ok(tracker_->initialise(to_float(small_camera()), T_vehicle_camera, start, parameters)));
  }

  static Rigid<double> camera_at(double x) {
    return {Quaternion<double>::Identity(), {x, 0.0, 0.0}};
  }

  /// What the camera sees after so many steps.
  static const Image& picture(int frame) {
    static std::vector<Image> images;
    static const PlaneScene wall(2.0, 0.22);
    while (static_cast<int>(images.size()) <= frame) {
      images.push_back(
          wall.render(small_camera(), camera_at(static_cast<double>(images.size()) * kStep)));
    }
    return images[static_cast<std::size_t>(frame)];
  }

  /// One frame, before which odometry reports `moved` m and `turn` rad/s.
  void step(const Image& image, double moved, float turn = 0.0F) {
    OdometrySample sample;
    sample.t_us = frame_ * kStepUs;
    sample.speed_mps = frame_ == 0 ? 0.0F : static_cast<float>(moved / (1e-6 * kStepUs));
    sample.turn = turn;
    EXPECT_TRUE(ok(tracker_->add_odometry(sample)));
    static_cast<void>(
        tracker_->process_frame(view(image, small_camera()), sample.t_us, TickSource{}, report_));
    EXPECT_EQ(report_.t_us, sample.t_us);
    ++frame_;
  }

  std::unique_ptr<Vehicle> tracker_ = std::make_unique<Vehicle>();
  FrameReport report_;
  int frame_ = 0;
};

}  // namespace cairn::test
