#pragma once

#include "cairn/base/status.hpp"
#include "cairn/geometry/types.hpp"

namespace cairn {

/// Pinhole camera with radial-tangential distortion (OpenCV's k1, k2, p1, p2, k3). Camera frame: z
/// forward, x right, y down; pixel (0, 0) is the centre of the first pixel.
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

  /// Nearest depth that is projected, m: closer points have no stable pixel.
  static constexpr T kMinDepth = T(0.05);
  /// Undistortion steps; fixed so that time is. Residual below 1e-3 px for field-of-view
  /// distortions up to 30 %.
  static constexpr int kUndistortSteps = 8;

  /// kBadConfig unless the focal lengths are positive, the principal point is inside the image, and
  /// every value is finite.
  Status validate() const;

  bool contains(const Vector2<T>& pixel, T margin_px = T(0)) const {
    return pixel.x() >= margin_px && pixel.y() >= margin_px &&
           pixel.x() <= static_cast<T>(width - 1) - margin_px &&
           pixel.y() <= static_cast<T>(height - 1) - margin_px;
  }

  /// Pixel of `p_camera` (m). kOutOfView, outputs untouched, when z < kMinDepth or the point lies
  /// so far out that the distortion polynomial has turned back on itself. The pixel may lie outside
  /// the image: see contains().
  Status project(const Vector3<T>& p_camera, Vector2<T>& pixel) const;

  /// Same, with the Jacobian d pixel / d p_camera (2x3).
  Status project(const Vector3<T>& p_camera, Vector2<T>& pixel, Matrix<T, 2, 3>& jacobian) const;

  /// Point at depth 1 (x, y, 1) seen at `pixel`, distortion removed.
  Vector3<T> unproject(const Vector2<T>& pixel) const;

  bool has_distortion() const {
    return k1 != T(0) || k2 != T(0) || p1 != T(0) || p2 != T(0) || k3 != T(0);
  }
};

extern template struct PinholeCamera<float>;
extern template struct PinholeCamera<double>;

}  // namespace cairn
