#pragma once

#include <random>
#include <vector>

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/vision/image.hpp"

namespace cairn::test {

/// An image inside a larger buffer whose border must never be written.
class GuardedImage {
 public:
  static constexpr int kGuard = 8;
  static constexpr std::uint8_t kGuardGrey = 0xA5;

  GuardedImage(int width, int height, std::uint8_t grey = 100)
      : width_(width),
        height_(height),
        stride_(width + 2 * kGuard),
        bytes_(index(0, height + 2 * kGuard), kGuardGrey) {
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) view().row(y)[x] = grey;
    }
  }
  MutableImageView view() {
    return {bytes_.data() + kGuard * stride_ + kGuard, width_, height_, stride_};
  }
  std::uint8_t at(int x, int y) { return view().row(y)[x]; }
  bool guard_is_whole() const {
    for (int y = 0; y < height_ + 2 * kGuard; ++y) {
      for (int x = 0; x < stride_; ++x) {
        const bool inside =
            x >= kGuard && x < kGuard + width_ && y >= kGuard && y < kGuard + height_;
        if (!inside && bytes_[index(x, y)] != kGuardGrey) return false;
      }
    }
    return true;
  }
  int changed(std::uint8_t grey = 100) {
    int count = 0;
    for (int y = 0; y < height_; ++y) {
      for (int x = 0; x < width_; ++x) count += at(x, y) != grey ? 1 : 0;
    }
    return count;
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(stride_) +
           static_cast<std::size_t>(x);
  }

  int width_;
  int height_;
  int stride_;
  std::vector<std::uint8_t> bytes_;
};

inline PinholeCamera<float> small_camera(float k1 = 0) {
  PinholeCamera<float> camera;
  camera.fx = 250;
  camera.fy = 250;
  camera.cx = 160;
  camera.cy = 120;
  camera.k1 = k1;
  camera.width = 320;
  camera.height = 240;
  return camera;
}

/// Camera at `eye` that looks at `target`, upright.
inline Rigid<float> look_at(const Vector3<float>& eye, const Vector3<float>& target) {
  const Vector3<float> z = (target - eye).normalized();
  const Vector3<float> x = z.cross(Vector3<float>(0, 0, 1)).normalized();
  Matrix3<float> axes;
  axes.col(0) = x;
  axes.col(1) = z.cross(x);
  axes.col(2) = z;
  Rigid<float> pose;
  pose.rotation = Quaternion<float>(axes);
  pose.translation = eye;
  return pose;
}

}  // namespace cairn::test
