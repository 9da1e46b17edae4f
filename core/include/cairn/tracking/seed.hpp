#pragma once

#include "cairn/tracking/appearance.hpp"
#include "cairn/tracking/patch_search.hpp"

namespace cairn {

/// A point whose depth is still uncertain: it is followed from frame to frame until it can become a
/// landmark (delayed initialisation).
struct Seed {
  Appearance appearance;     ///< first view, at its keyframe
  Vector3<float> first_ray;  ///< (x, y, 1) in the first camera
  Vector2<float> pixel;      ///< last measured
  float rho = 0.0F;          ///< 1 / depth (z) in the first camera, 1/m
  int keyframe = 0;          ///< slot of the keyframe at which it began
  int seen = 1;
  int misses = 0;
};

/// A seed whose depth has converged, on the scale of the distances between the caller's poses.
struct ConvergedSeed {
  Appearance appearance;        ///< T_world_reference: the first camera in the pool's own world
  Rigid<float> T_camera_first;  ///< first camera as seen from the present one
  Vector3<float> ray;           ///< (x, y, 1) in the present camera
  float depth_m = 0.0F;         ///< z in the present camera, if T_camera_first has the right length
  float sigma_depth_m = 0.0F;   ///< of it, from the pixels alone
  Vector2<float> pixel;
  LandmarkId keyframe = kNoLandmark;
};

struct SeedParameters {
  float initial_depth_m = 4.0F;
  float initial_sigma_rho = 0.25F;  ///< 1/m: everything beyond about 1.3 m within 2 sigma
  float sigma_px = 0.3F;
  float max_relative_sigma = 0.2F;  ///< sigma(rho) / rho of a converged seed
  float min_depth_m = 0.5F;
  float max_depth_m = 25.0F;
  float depth_inflation = 1.5F;   ///< of the depth's sigma when it has converged
  float sigma_yaw_rad = 0.002F;   ///< of the caller's rotation since the frame before
  float sigma_pitch_rad = 1e-4F;  ///< same, about the camera's x axis
  float sigma_roll_rad = 0.0F;    ///< of its rotation since the keyframe, about the optical axis
  float off_path = 0.0F;          ///< error of the camera's way since a first view, of its length
  float gate = 9.21F;
  int min_views = 3;  ///< one more than a depth needs
  int max_views = 150;
  int max_misses = 2;
  PatchSearchParameters search;

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const {
    const bool good =
        is_positive(initial_depth_m) && is_positive(initial_sigma_rho) && is_positive(sigma_px) &&
        is_positive(max_relative_sigma) && is_positive(min_depth_m) &&
        is_positive(depth_inflation) && is_positive(gate) && off_path >= 0.0F && off_path <= 1.0F &&
        is_finite(max_depth_m) && max_depth_m > min_depth_m && is_finite(sigma_yaw_rad) &&
        sigma_yaw_rad >= 0.0F && is_finite(sigma_pitch_rad) && sigma_pitch_rad >= 0.0F &&
        is_finite(sigma_roll_rad) && sigma_roll_rad >= 0.0F && min_views >= 1 &&
        max_views >= min_views && max_misses >= 0 && ok(search.validate());
    return good ? Status::kOk : Status::kBadConfig;
  }
};

}  // namespace cairn
