#include <algorithm>
#include <cmath>

#include "vehicle_by_a_wall.hpp"

namespace cairn {
namespace {

class VehicleInATrickyPlace : public test::VehicleByAWall {
 protected:
  VehicleInATrickyPlace() : VehicleByAWall(0.05F, 0.1F) {}

  void step(const Image& image, double moved) {
    VehicleByAWall::step(image, moved);
    truth_ += moved;
    const PlanarPose<float> pose = tracker_->filter().mean_pose();
    const Matrix3<float> P = tracker_->filter().pose_covariance();
    // A millimetre and a milliradian are left to rounding and to the patch alignment's bias.
    worst_sigmas_ = std::max({worst_sigmas_,
                              std::abs(static_cast<double>(pose.position.x()) - truth_) /
                                  std::sqrt(static_cast<double>(P(0, 0)) + 1e-6),
                              std::abs(static_cast<double>(pose.position.y())) /
                                  std::sqrt(static_cast<double>(P(1, 1)) + 1e-6),
                              std::abs(static_cast<double>(pose.heading)) /
                                  std::sqrt(static_cast<double>(P(2, 2)) + 1e-6)});
  }

  double truth_ = 0.0;
  double worst_sigmas_ = 0.0;
};

TEST_F(VehicleInATrickyPlace, TilesThatAllLookAlikeMakeItJumpNowhere) {
  test::PlaneScene tiles(2.0, 0.22);
  tiles.repeat(1);
  for (int k = 0; k < 60; ++k) {
    step(tiles.render(test::small_camera(), camera_at(k * kStep)), k == 0 ? 0.0 : kStep);
  }
  EXPECT_LT(worst_sigmas_, 3.0);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

/// Something with a texture of its own fills 40 % of the picture and moves against the drive.
TEST_F(VehicleInATrickyPlace, AMovingThingDoesNotTakeItAlong) {
  const test::PlaneScene wall(2.0, 0.22);
  const test::PlaneScene thing(1.0, 0.15, 5);
  const PinholeCamera<double> camera = test::small_camera();
  for (int k = 0; k < 75; ++k) {
    Image image = wall.render(camera, camera_at(k * kStep));
    if (k >= 25) {  // enters once the wall is mapped
      const Image moving = thing.render(camera, camera_at(-0.015 * k));
      const int edge = camera.width * 6 / 10;
      for (int v = 0; v < camera.height; ++v) {
        for (int u = edge; u < camera.width; ++u) {
          const auto i = static_cast<std::size_t>(v * camera.width + u);
          image[i] = moving[i];
        }
      }
    }
    step(image, k == 0 ? 0.0 : kStep);
  }
  EXPECT_LT(worst_sigmas_, 3.0);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

/// Registration error of a resting camera: rms of what a pixel of the map moves from frame to
/// frame.
TEST_F(VehicleInATrickyPlace, ARestingCameraDoesNotJitter) {
  const test::PlaneScene wall(2.0, 0.22);
  const PinholeCamera<double> camera = test::small_camera();
  Image last;
  for (int k = 0; k < 45; ++k) {
    last = wall.render(camera, camera_at(k * kStep));
    step(last, k == 0 ? 0.0 : kStep);
  }
  std::uint32_t noise = 1;
  double sum = 0.0;
  int count = 0;
  Vector2<float> before = Vector2<float>::Zero();
  for (int k = 0; k < 60; ++k) {
    Image image = last;
    for (std::uint8_t& grey : image) {  // read-out noise, 2 grey levels rms
      noise = noise * 1664525U + 1013904223U;
      const int off = static_cast<int>((noise >> 24U) % 8U) - 3;
      grey = static_cast<std::uint8_t>(clamp(int{grey} + off, 0, 255));
    }
    step(image, 0.0);
    Vector2<float> pixel;
    const Vector3<float> p_world(static_cast<float>(truth_), 2.0F, 1.0F);
    ASSERT_TRUE(
        ok(test::to_float(camera).project(report_.T_map_camera.inverse() * p_world, pixel)));
    if (k > 0) {
      sum += static_cast<double>((pixel - before).squaredNorm());
      ++count;
    }
    before = pixel;
  }
  EXPECT_LT(std::sqrt(sum / count), 0.3);
  EXPECT_LT(worst_sigmas_, 3.0);
}

}  // namespace
}  // namespace cairn
