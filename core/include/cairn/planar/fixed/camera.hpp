#pragma once

#include "cairn/planar/fixed/types.hpp"

namespace cairn {

using FixedTangent = Fixed<std::int32_t, 28>;        ///< of a ray's angles, lens coefficients; +-8
using FixedPixel = Fixed<std::int32_t, 16>;          ///< px, +-32768
using FixedPixelVariance = Fixed<std::int64_t, 24>;  ///< px^2

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

/// Pitch and roll of a vehicle's body, as VehicleTilt.
struct FixedTilt {
  FixedAngle pitch;
  FixedAngle roll;
};

/// A landmark found in the image, as PixelMatch.
struct FixedPixelMatch {
  LandmarkId id = kNoLandmark;
  FixedPixel pixel[2];
  bool inlier = false;  ///< set by the update: used by the filter
};

/// As PixelPrediction.
struct FixedPixelPrediction {
  LandmarkId id = kNoLandmark;
  int slot = -1;
  FixedPixel pixel[2];
  FixedLength p_camera[3];  ///< expected point in the camera frame, m
  FixedPixelVariance xx;    ///< innovation covariance
  FixedPixelVariance xy;
  FixedPixelVariance yy;
};

/// A landmark to search for, as PlannedSearch.
struct FixedPlannedPixel {
  FixedPixelPrediction prediction;
  Fixed<std::int64_t, 16> priority;  ///< determinant of the innovation covariance, px^4
};

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
/// From the vehicle's axes, tilted with it, to the level ones.
FixedRotation rotation_of(const FixedTilt& tilt);
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

/// Fraction bits of a pixel's innovation and noise in metres.
inline constexpr int kPixelBits = 40;

/// What an update reads of a pixel: two rows that act on the vector from vehicle to landmark, in
/// the world's axes, and on pitch and roll. Each is multiplied by the depth over the focal length,
/// z / f, so that all is of metres and no row is longer than 8.
struct FixedPixelRows {
  FixedPixel pixel[2];        ///< expected
  FixedTangent h[2][3];       ///< by the vector
  FixedLength tilt[2][2];     ///< by pitch and roll, m
  FixedTangent depth[3];      ///< the depth by the vector
  FixedLength p_camera[3];    ///< the point, m
  std::int64_t per_pixel[2];  ///< z / f, m, kPixelBits fraction bits
};

/// A camera on a vehicle, as CameraView.
struct FixedCameraView {
  const FixedCamera* camera = nullptr;
  FixedRotation R_camera_world;
  FixedLength t_camera[3];  ///< the vehicle's origin in the camera frame
  bool tilts = false;
  FixedRatio axes[2][3];  ///< of pitch and roll, in the world's axes

  /// `tilt`: nullptr for a body that does not tilt.
  FixedCameraView(const FixedCamera& pinhole, const FixedMount& mount, FixedRatio cosine,
                  FixedRatio sine, const FixedTilt* tilt, std::uint32_t& saturations);

  /// Of a landmark at `relative` from the vehicle, in the world's axes. False when it is nearer
  /// than 0.3 m or outside the camera's model.
  bool linearise(const FixedLength (&relative)[3], FixedPixelRows& out,
                 std::uint32_t& saturations) const;
  /// Its pixel alone; false outside the camera's model.
  bool see(const FixedLength (&relative)[3], FixedProjection& out,
           std::uint32_t& saturations) const;

 private:
  void to_camera(const FixedLength (&relative)[3], FixedLength (&p)[3],
                 std::uint32_t& saturations) const;
};

}  // namespace detail
}  // namespace cairn
