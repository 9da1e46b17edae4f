#pragma once

#include "cairn/geometry/fixed_camera.hpp"
#include "cairn/planar/fixed/types.hpp"

namespace cairn {

using FixedPixelVariance = Fixed<std::int64_t, 24>;  ///< px^2

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

/// From the vehicle's axes, tilted with it, to the level ones.
FixedRotation rotation_of(const FixedTilt& tilt);
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
