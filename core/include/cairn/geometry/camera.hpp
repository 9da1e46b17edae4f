#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/geometry/types.hpp"

namespace cairn {

/// What the coefficients of a lens mean.
enum class Lens : std::uint8_t {
  /// OpenCV's k1, k2, p1, p2, k3 and, where they are not 0, k4, k5, k6: distance from the axis
  /// r (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6) and a tangential part.
  kRadialTangential = 0,
  /// Kannala and Brandt (2006), OpenCV's fisheye, "equidistant": theta (1 + k1 theta^2 + k2 theta^4
  /// + k3 theta^6 + k4 theta^8), theta the angle with the axis. p1, p2, k5 and k6 are 0.
  kFisheye = 1
};

/// Camera with one centre of projection and a lens. Camera frame: z forward, x right, y down; pixel
/// (0, 0) is the centre of the first pixel.
template <class T>
struct PinholeCamera {
  T fx = T(0);
  T fy = T(0);
  T cx = T(0);
  T cy = T(0);
  T k1 = T(0);
  T k2 = T(0);
  T p1 = T(0);
  T p2 = T(0);
  T k3 = T(0);
  int width = 0;
  int height = 0;
  T k4 = T(0);
  T k5 = T(0);
  T k6 = T(0);
  Lens lens = Lens::kRadialTangential;

  /// Nearest depth that is projected, m: closer points have no stable pixel.
  static constexpr T kMinDepth = T(0.05);
  /// Tangent of the widest angle with the axis, 80 degrees, at which a fisheye or a rational lens
  /// is used: rays are (x, y, 1).
  static constexpr T kWidestFisheyeRay = T(5.67);
  /// Area that a lens gives what it shows at the picture's border, over that without distortion:
  /// strong pincushion is 4. Beyond, the numbers are no lens's.
  static constexpr T kMostEnlarged = T(100);

  /// kBadConfig unless every value is finite, the focal lengths are 1e-3 to 1e4 image sides, the
  /// centre is inside the image, and every pixel has one ray: a distortion that turns back on
  /// itself inside the image, with its tangential part or without, is no description of a lens, nor
  /// is one beyond kMostEnlarged, and a fisheye picture that reaches beyond kWidestFisheyeRay is to
  /// be cropped. Looked at on the ways to the corners and the middles of the sides. Cost: eight
  /// undistortions, 192 distortions with tangential terms.
  Status validate() const;

  /// kBadConfig as validate(), of the numbers alone: what code that is called in every frame checks
  /// of a camera that was validated before.
  Status check_numbers() const;

  bool contains(const Vector2<T>& pixel, T margin_px = T(0)) const {
    return pixel.x() >= margin_px && pixel.y() >= margin_px &&
           pixel.x() <= static_cast<T>(width - 1) - margin_px &&
           pixel.y() <= static_cast<T>(height - 1) - margin_px;
  }

  /// Pixel of `p_camera` (m). kOutOfView, outputs untouched, when z < kMinDepth or the point lies
  /// at or beyond the radius at which the distortion turns back on itself, or beyond
  /// kWidestFisheyeRay. The pixel may lie outside the image: see contains().
  Status project(const Vector3<T>& p_camera, Vector2<T>& pixel) const;

  /// Same, with the Jacobian d pixel / d p_camera (2x3).
  Status project(const Vector3<T>& p_camera, Vector2<T>& pixel, Matrix<T, 2, 3>& jacobian) const;

  /// Point at depth 1 (x, y, 1) seen at `pixel`, distortion removed; it projects to `pixel` again
  /// within 0.05 px (double: 1e-3 px where |p1|, |p2| <= 0.02). kOutOfView where no ray has this
  /// pixel; `ray` is then the outermost one in its direction. Inside the image of a camera that
  /// validate() accepts there always is one. Cost: at most 16 + 4 steps of Newton's method, 24 + 4
  /// of a rational or a fisheye lens.
  Status unproject(const Vector2<T>& pixel, Vector3<T>& ray) const;

  /// The same ray without the status.
  Vector3<T> unproject(const Vector2<T>& pixel) const;

  /// The camera that sees a direction (x, y, 1) where this one sees (scale x, scale y, 1): another
  /// focal length, every pixel's distortion as it is. Domain: scale above 0, no fisheye lens.
  PinholeCamera with_focal_scale(T scale) const {
    const T squared = scale * scale;
    PinholeCamera scaled = *this;
    scaled.fx *= scale;
    scaled.fy *= scale;
    scaled.k1 *= squared;
    scaled.k2 *= squared * squared;
    scaled.p1 *= scale;
    scaled.p2 *= scale;
    scaled.k3 *= squared * squared * squared;
    scaled.k4 *= squared;
    scaled.k5 *= squared * squared;
    scaled.k6 *= squared * squared * squared;
    return scaled;
  }

  bool has_distortion() const {
    return k1 != T(0) || k2 != T(0) || p1 != T(0) || p2 != T(0) || k3 != T(0) || is_rational() ||
           lens == Lens::kFisheye;
  }
  bool is_rational() const {
    return lens == Lens::kRadialTangential && (k4 != T(0) || k5 != T(0) || k6 != T(0));
  }
};

extern template struct PinholeCamera<float>;
extern template struct PinholeCamera<double>;

}  // namespace cairn
