#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/vision/image.hpp"

namespace cairn::test {

/// A textured plane z = depth_m of the world, seen by a camera: the smallest scene with true
/// geometry. The texture is a patchwork of random grey tiles, which gives corners at known, stable
/// places.
class PlaneScene {
 public:
  explicit PlaneScene(double depth_m, double tile_m = 0.15, std::uint32_t seed = 1)
      : depth_m_(depth_m), tile_m_(tile_m), seed_(seed) {}

  /// Makes the texture repeat every `period` tiles, in both directions.
  void repeat(int period) { period_ = period; }

  /// Renders with 4x4 samples a pixel.
  std::vector<std::uint8_t> render(const PinholeCamera<double>& camera,
                                   const Rigid<double>& T_world_camera) const {
    constexpr int kSamples = 4;
    std::vector<std::uint8_t> image(static_cast<std::size_t>(camera.width) *
                                    static_cast<std::size_t>(camera.height));
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        double sum = 0.0;
        for (int k = 0; k < kSamples * kSamples; ++k) {
          const int row = k / kSamples;
          const double du = (k % kSamples + 0.5) / kSamples - 0.5;
          const double dv = (row + 0.5) / kSamples - 0.5;
          sum += sample(camera, T_world_camera, u + du, v + dv);
        }
        const std::size_t at = static_cast<std::size_t>(v) * static_cast<std::size_t>(camera.width);
        image[at + static_cast<std::size_t>(u)] =
            static_cast<std::uint8_t>(std::lround(sum / (kSamples * kSamples)));
      }
    }
    return image;
  }

 private:
  double sample(const PinholeCamera<double>& camera, const Rigid<double>& T_world_camera, double u,
                double v) const {
    const Vector3<double> ray = T_world_camera.rotation * camera.unproject({u, v});
    if (ray.z() < 1e-6) return 0.0;
    const double scale = (depth_m_ - T_world_camera.translation.z()) / ray.z();
    const Vector3<double> p = T_world_camera.translation + scale * ray;
    return value(p.x() / tile_m_, p.y() / tile_m_);
  }

  /// Grey value at a point of the plane, in tiles: one rectangle a tile, on a grey ground.
  double value(double x, double y) const {
    const double column = std::floor(x);
    const double row = std::floor(y);
    std::uint32_t h =
        seed_ ^ (tile_number(column) * 0x9E3779B1U) ^ (tile_number(row) * 0x85EBCA77U);
    h ^= h >> 15U;
    h *= 0x2C1B3C6DU;
    h ^= h >> 12U;
    h *= 0x297A2D39U;
    h ^= h >> 15U;
    const double left = 0.1 + 0.3 * ((h >> 8U) & 15U) / 16.0;
    const double top = 0.1 + 0.3 * ((h >> 12U) & 15U) / 16.0;
    const double right = 0.6 + 0.3 * ((h >> 16U) & 15U) / 16.0;
    const double bottom = 0.6 + 0.3 * ((h >> 20U) & 15U) / 16.0;
    const double fx = x - column;
    const double fy = y - row;
    const bool inside = fx > left && fx < right && fy > top && fy < bottom;
    const double contrast = 50.0 + (h & 63U);
    return inside ? 128.0 + ((h & 64U) != 0U ? contrast : -contrast) : 128.0;
  }

  std::uint32_t tile_number(double k) const {
    const int number = static_cast<int>(k);
    if (period_ == 0) return static_cast<std::uint32_t>(number);
    return static_cast<std::uint32_t>((number % period_ + period_) % period_);
  }

  int period_ = 0;
  double depth_m_;
  double tile_m_;
  std::uint32_t seed_;
};

inline PinholeCamera<double> small_camera() {
  PinholeCamera<double> camera;
  camera.fx = 260;
  camera.fy = 260;
  camera.cx = 160;
  camera.cy = 120;
  camera.width = 320;
  camera.height = 240;
  return camera;
}

/// Of an undistorted camera.
inline PinholeCamera<float> to_float(const PinholeCamera<double>& c) {
  PinholeCamera<float> f;
  f.fx = static_cast<float>(c.fx);
  f.fy = static_cast<float>(c.fy);
  f.cx = static_cast<float>(c.cx);
  f.cy = static_cast<float>(c.cy);
  f.width = c.width;
  f.height = c.height;
  return f;
}

inline Rigid<float> to_float(const Rigid<double>& T) {
  return {T.rotation.cast<float>(), T.translation.cast<float>()};
}

inline ImageView view(const std::vector<std::uint8_t>& image, const PinholeCamera<double>& camera) {
  return {image.data(), camera.width, camera.height, camera.width};
}

}  // namespace cairn::test
