#pragma once

#include <vector>

#include "host_sim/sources/image_sequence.hpp"

namespace cairn::host {

/// Real points of a recorded scene whose camera poses are known, as the yardstick of the
/// registration error: corners followed through the pictures (Shi and Tomasi 1994; Lucas and Kanade
/// forth and back) and triangulated with the reference poses.
struct SceneTrackSettings {
  int alive = 120;              ///< corners followed at a time
  int renew_every = 10;         ///< frames between looks for new corners
  int min_frames = 30;          ///< of a track
  int max_frames = 150;         ///< longer tracks end and begin anew: they drift
  double max_return_px = 0.3;   ///< between a corner and itself followed forth and back
  double min_angle_rad = 0.05;  ///< between the outer rays of a track
  double max_rms_px = 3.0;      ///< reprojection error of a track with the reference poses
  double max_error_px = 7.5;    ///< the same of any of its frames
};

/// Adds scene points to the frames (true_T_world_camera must be there); returns how many. The pixel
/// of a point is where it was followed to, its place that of the triangulated point. Reads all
/// pictures. Throws InputError as read_grey_image().
int add_scene_tracks(const PinholeCamera<double>& camera, const SceneTrackSettings& settings,
                     std::vector<SequenceFrame>& frames);

}  // namespace cairn::host
