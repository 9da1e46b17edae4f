#pragma once

#include <optional>
#include <vector>

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// What the registration error of one frame is computed from.
struct RegistrationInput {
  std::optional<Rigid<double>> T_world_camera;  ///< estimate; nothing while there is none
  std::vector<ScenePointView> views;
  /// Of the camera that objects are drawn with, as a factor on the one that was told. The pose that
  /// was estimated with it goes with it alone.
  double focal_scale = 1.0;
};

struct RegistrationSettings {
  /// Frames over which a point's place in the map is fixed, from the first in which it is well
  /// seen; the error counts from the frame after.
  int anchor_frames = 1;
  double anchor_distance_m = 10.0;  ///< well seen: nearer than this,
  double anchor_margin_px = 16.0;   ///< and further inside the image than this
  /// Map units per metre. Video alone does not give it: nothing = the one value for the whole run
  /// that makes the mean error smallest.
  std::optional<double> map_scale = 1.0;
};

struct RegistrationResult {
  double map_scale = 1.0;
  std::vector<std::optional<double>> frame_px;  ///< mu of each frame
  int points = 0;                               ///< anchored
};

/// Registration error mu = (1/N) sum |alpha_i - alpha_i'| (paper A, eq. 29; Errata: printed without
/// the norm that its text states). Every scene point is anchored in the map at its true place
/// relative to the camera, carried by the estimated pose; from then on its true pixel is compared
/// with its projection by the estimated pose: what a user sees as a virtual object that drifts.
/// Where the tracker estimates the focal length, the place is that which the picture and the true
/// depth give through its camera, and it is projected by that.
RegistrationResult evaluate_registration(const std::vector<RegistrationInput>& frames,
                                         const PinholeCamera<double>& camera,
                                         const RegistrationSettings& settings);

}  // namespace cairn::host
