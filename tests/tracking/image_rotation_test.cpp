#include "cairn/tracking/image_rotation.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/geometry/rigid.hpp"

namespace cairn {
namespace {

/// A textured sphere far away, seen by a camera that turns.
class Sky {
 public:
  Sky() {
    camera_.width = 640;
    camera_.height = 480;
    camera_.fx = camera_.fy = 520.0F;
    camera_.cx = 318.0F;
    camera_.cy = 243.0F;
  }
  const PinholeCamera<float>& camera() const { return camera_; }

  /// The picture at R_world_camera = exp(rotation).
  void show(const Vector3<float>& rotation, ImageRotation& pictures, float gain = 1.0F,
            float offset = 0.0F, double phase = 0.0) {
    const Matrix3<float> R = rotation_exp(rotation).toRotationMatrix();
    pixels_.resize(static_cast<std::size_t>(camera_.width) * camera_.height);
    for (int v = 0; v < camera_.height; ++v) {
      for (int u = 0; u < camera_.width; ++u) {
        const Vector3<float> ray =
            R * Vector3<float>((static_cast<float>(u) - camera_.cx) / camera_.fx,
                               (static_cast<float>(v) - camera_.cy) / camera_.fy, 1.0F);
        const double x = ray.x() / ray.norm() + phase;
        const double y = ray.y() / ray.norm() - phase;
        const double grey = 120.0 + 25.0 * std::sin(9.0 * x + 2.0 * std::sin(7.0 * y)) +
                            25.0 * std::sin(13.0 * y + 3.0 * std::sin(5.0 * x)) +
                            20.0 * std::sin(31.0 * x * y + 23.0 * (x - y));
        pixels_[static_cast<std::size_t>(v) * camera_.width + u] =
            static_cast<std::uint8_t>(std::fmin(255.0, std::fmax(0.0, gain * grey + offset)));
      }
    }
    ImageView image;
    image.data = pixels_.data();
    image.width = image.stride = camera_.width;
    image.height = camera_.height;
    pictures.take(image);
  }

 private:
  PinholeCamera<float> camera_;
  std::vector<std::uint8_t> pixels_;
};

constexpr float kCell_rad = 16.0F / 520.0F;

TEST(ImageRotation, FindsTurnsOfSeveralCellsWithoutAHint) {
  Sky sky;
  const Vector3<float> turns[] = {
      {0.01F, -0.02F, 0.0F}, {0.0F, 0.15F, 0.0F}, {-0.12F, 0.05F, 0.02F}, {0.03F, -0.1F, -0.04F}};
  for (const Vector3<float>& turn : turns) {
    ImageRotation pictures;
    const Vector3<float> start(0.05F, 0.1F, -0.05F);
    sky.show(start, pictures);
    const Quaternion<float> turned = rotation_exp(start) * rotation_exp(turn);
    sky.show(rotation_log(turned), pictures);
    ImageRotation::Result result;
    ASSERT_TRUE(pictures.align(sky.camera(), Vector3<float>::Zero(), result)) << turn.y();
    EXPECT_LT((result.rotation - turn).norm(), 0.1F * kCell_rad) << turn.y();
    EXPECT_GT(result.correlation, 0.95F);
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT(std::abs(result.rotation(i) - turn(i)), 3.0F * result.sigma_rad(i)) << i;
    }
  }
}

/// A black and white board, half of whose pixels change to the other: the largest differences
/// that there are.
TEST(ImageRotation, FindsATurnInAPictureOfFullContrast) {
  PinholeCamera<float> camera = Sky().camera();
  camera.fx = camera.fy = 4000.0F;
  const auto board = [&](int shift, ImageRotation& pictures) {
    constexpr int kField_px = 96;
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(camera.width) * camera.height);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const bool white = ((u + shift) / kField_px + v / (2 * kField_px)) % 2 == 0;
        pixels[static_cast<std::size_t>(v) * camera.width + u] = white ? 255 : 0;
      }
    }
    ImageView image;
    image.data = pixels.data();
    image.width = image.stride = camera.width;
    image.height = camera.height;
    pictures.take(image);
  };
  constexpr int kShift_px = 54;
  ImageRotation pictures;
  board(0, pictures);
  board(kShift_px, pictures);
  ImageRotation::Result result;
  ASSERT_TRUE(pictures.align(camera, Vector3<float>::Zero(), result));
  constexpr float kCell_px = 16.0F;  // edges without a ramp are aligned to about a cell
  EXPECT_NEAR(result.rotation.y() * camera.fx, static_cast<float>(kShift_px), kCell_px);
}

TEST(ImageRotation, DoesNotMindAnotherExposure) {
  Sky sky;
  ImageRotation pictures;
  const Vector3<float> turn(0.0F, 0.06F, 0.0F);
  sky.show(Vector3<float>::Zero(), pictures);
  sky.show(turn, pictures, 0.95F, 20.0F);
  ImageRotation::Result result;
  ASSERT_TRUE(pictures.align(sky.camera(), Vector3<float>::Zero(), result));
  EXPECT_LT((result.rotation - turn).norm(), 0.25F * kCell_rad);
}

TEST(ImageRotation, SaysNothingWithoutTwoPicturesOfOnePlace) {
  Sky sky;
  ImageRotation pictures;
  ImageRotation::Result result;
  result.correlation = -7.0F;
  EXPECT_FALSE(pictures.align(sky.camera(), Vector3<float>::Zero(), result));
  sky.show(Vector3<float>::Zero(), pictures);
  EXPECT_FALSE(pictures.align(sky.camera(), Vector3<float>::Zero(), result));
  // Another place.
  sky.show(Vector3<float>(0.0F, 0.0F, 2.0F), pictures, 1.0F, 0.0F, 40.0);
  EXPECT_FALSE(pictures.align(sky.camera(), Vector3<float>::Zero(), result));
  // A wall without texture.
  sky.show(Vector3<float>::Zero(), pictures, 0.0F, 90.0F);
  sky.show(Vector3<float>::Zero(), pictures, 0.0F, 90.0F);
  EXPECT_FALSE(pictures.align(sky.camera(), Vector3<float>::Zero(), result));
  pictures.reset();
  sky.show(Vector3<float>::Zero(), pictures);
  EXPECT_FALSE(pictures.align(sky.camera(), Vector3<float>::Zero(), result));
  EXPECT_EQ(result.correlation, -7.0F);
}

TEST(ImageRotation, ForgetsAtAPictureTooSmall) {
  Sky sky;
  ImageRotation pictures;
  sky.show(Vector3<float>::Zero(), pictures);
  const std::uint8_t pixels[16] = {};
  ImageView small;
  small.data = pixels;
  small.width = small.height = small.stride = 4;
  pictures.take(small);
  sky.show(Vector3<float>::Zero(), pictures);
  ImageRotation::Result result;
  EXPECT_FALSE(pictures.align(sky.camera(), Vector3<float>::Zero(), result));
}

}  // namespace
}  // namespace cairn
