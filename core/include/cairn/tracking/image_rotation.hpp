#pragma once

#include <cstdint>

#include "cairn/geometry/camera.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

namespace work {

/// ImageRotation::align().
inline constexpr int image_rotation(int iterations) {
  return 300 + 140 * iterations;
}

/// ImageRotation::take(), in units.
inline constexpr int coarse_image(int width, int height) {
  return 20 + width * height / 2000;
}

}  // namespace work

/// A camera's rotation from one picture to the next, from copies of some thousand pixels: without
/// features, at any speed that leaves the pictures half in common. What a translation moves counts
/// as rotation too, so that it says where to search and not how the camera stands.
class ImageRotation {
 public:
  static constexpr int kColumns = 40;
  static constexpr int kRows = 30;
  static constexpr int kMaxIterations = 5;

  struct Result {
    /// Rotation vector, camera axes, rad: R_previous_present = exp(rotation).
    Vector3<float> rotation = Vector3<float>::Zero();
    Vector3<float> sigma_rad = Vector3<float>::Zero();  ///< of a rotation without translation
    float correlation = 0.0F;                           ///< of the pictures where they overlap
    int iterations = 0;                                 ///< that it took
  };

  /// Forgets the pictures.
  void reset() { taken_ = 0; }

  /// Takes the present picture; the one before becomes the previous one. One smaller than
  /// kColumns x kRows only makes it forget. Domain: a valid image.
  void take(const ImageView& image);

  /// Aligns the two last pictures taken, `expected` (rad, as Result::rotation) being one of the
  /// starts. False, `result` untouched but for the iterations: fewer than two pictures, no texture,
  /// or no agreement. Cost: 59 comparisons of at most 300 cells, kMaxIterations passes over
  /// half of the cells.
  bool align(const PinholeCamera<float>& camera, const Vector3<float>& expected,
             Result& result) const;

 private:
  struct Coarse {
    std::int16_t values[kRows][kColumns];  ///< mean of a cell's pixels, 16 to a grey level
  };
  struct Optics;
  struct Sums;

  const Coarse& present() const { return images_[present_]; }
  const Coarse& previous() const { return images_[1 - present_]; }
  Optics optics_of(const PinholeCamera<float>& camera) const;
  float misfit(const Optics& optics, const Vector3<float>& rotation) const;
  float shifted_misfit(int dx, int dy) const;
  Vector3<float> best_shift(const Optics& optics) const;
  Sums equations(const Optics& optics, const Vector3<float>& rotation, float offset) const;
  bool sample(const Optics& optics, const Vector3<float>& ray, float& value) const;

  Coarse images_[2] = {};
  int present_ = 0;
  int taken_ = 0;
};

}  // namespace cairn
