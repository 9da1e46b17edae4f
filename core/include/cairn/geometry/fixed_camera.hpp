#pragma once

#include "cairn/base/status.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/fixed_math.hpp"

namespace cairn {

using FixedLength = Fixed<std::int32_t, 20>;   ///< m, +-2048
using FixedTangent = Fixed<std::int32_t, 28>;  ///< of a ray's angles, lens coefficients; +-8
using FixedPixel = Fixed<std::int32_t, 16>;    ///< px, +-32768

/// As PinholeCamera with Lens::kRadialTangential, without the coefficients of a rational lens.
struct FixedCamera {
  FixedPixel fx;
  FixedPixel fy;
  FixedPixel cx;
  FixedPixel cy;
  FixedTangent k1;
  FixedTangent k2;
  FixedTangent p1;
  FixedTangent p2;
  FixedTangent k3;
  int width = 0;
  int height = 0;

  /// kBadConfig unless focal lengths and size are positive.
  Status check_numbers() const;
  bool has_distortion() const {
    return k1.raw() != 0 || k2.raw() != 0 || k3.raw() != 0 || p1.raw() != 0 || p2.raw() != 0;
  }
  /// Whether a pixel lies in the picture, `margin` or more from its border.
  bool contains(const FixedPixel (&pixel)[2], FixedPixel margin = FixedPixel()) const;
};

/// Pose of a camera in the vehicle frame: unit quaternion (w, x, y, z) and origin, m.
struct FixedMount {
  FixedRatio w = FixedRatio::nearest(1.0);
  FixedRatio x;
  FixedRatio y;
  FixedRatio z;
  FixedLength origin[3];

  /// kInvalidArgument unless the quaternion's squared length is 1 to 1e-4.
  Status check() const;
};

/// By the bits of their numbers. kBadConfig for a lens that has no fixed form: a fisheye, a
/// rational one, a coefficient above 8.
Status fixed_of(const PinholeCamera<float>& camera, FixedCamera& out);
FixedMount fixed_of(const Rigid<float>& T_vehicle_camera, std::uint32_t& saturations);

namespace detail {

/// Rotation matrix; row i holds the target's axis i in the source's axes.
struct FixedRotation {
  FixedRatio r[3][3];

  FixedRotation() {
    for (int i = 0; i < 3; ++i) r[i][i] = FixedRatio::nearest(1.0);
  }
  FixedRotation operator*(const FixedRotation& other) const;
  FixedRotation transposed() const;
  /// R v; saturates, counted.
  void turn(const FixedLength (&v)[3], FixedLength (&out)[3], std::uint32_t& saturations) const;
};
FixedRotation rotation_of(const FixedMount& mount);
/// About the vertical, from the level vehicle's axes to the world's.
FixedRotation rotation_about_vertical(FixedRatio cosine, FixedRatio sine);

/// Pixel of a point, and its derivative without the factors f / z: row 0 by the camera's axes is
/// fx / z (d00, d01, c0), row 1 fy / z (d01, d11, c1).
struct FixedProjection {
  FixedPixel pixel[2];
  FixedTangent rows[2][3];
};
/// False, `out` untouched: nearer than 0.05 m, more than 76 degrees from the axis (with a
/// distortion 63), or where the distortion turns back on itself, which is looked for at 16 radii.
bool project(const FixedCamera& camera, const FixedLength (&p_camera)[3], FixedProjection& out,
             std::uint32_t& saturations);

/// Of a point by the tangents of its ray, whose third component is 1. False where the distortion
/// leaves its range.
bool project_ray(const FixedCamera& camera, FixedTangent a, FixedTangent b, FixedProjection& out,
                 std::uint32_t& saturations);

/// The ray (a, b, 1) of a pixel to a hundredth of a pixel; false where none is found. Cost: at most
/// 12 steps of Newton's method, none without a distortion.
bool unproject(const FixedCamera& camera, const FixedPixel (&pixel)[2], FixedTangent (&ray)[2]);

/// The pixel alone, of any point of the camera frame.
bool project_point(const FixedCamera& camera, const FixedLength (&p_camera)[3],
                   FixedPixel (&pixel)[2], std::uint32_t& saturations);

}  // namespace detail
}  // namespace cairn
