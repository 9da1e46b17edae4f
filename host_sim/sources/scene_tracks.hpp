#pragma once

#include <optional>
#include <vector>

#include <opencv2/core.hpp>

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

/// What a driving car sees: points that pass within a second, 50 px from one picture to the next.
SceneTrackSettings scene_tracks_of_a_drive();

/// Scene points by the frames in which they are seen, in their order.
struct ScenePoints {
  int count = 0;
  std::vector<std::vector<ScenePointView>> frames;
};

/// Follows corners through pictures that come one after the other.
class SceneTracker {
 public:
  SceneTracker(const PinholeCamera<double>& camera, const SceneTrackSettings& settings)
      : camera_(camera), settings_(settings) {}

  /// The next picture, of the camera's size, and the camera's true pose; without one all tracks
  /// end.
  void add(const cv::Mat& grey, const std::optional<Rigid<double>>& T_world_camera);

  /// Triangulates what was followed. The pixel of a point is where it was followed to, its place
  /// that of the triangulated point.
  ScenePoints finish();

 private:
  struct Track {
    std::size_t first = 0;  ///< frame of the first pixel; the others follow without a gap
    std::vector<Vector2<double>> pixels;
  };

  void step(const cv::Mat& grey);
  void renew(const cv::Mat& grey);
  void end(Track& track);
  void end_all();
  bool intersect_rays(const Track& track, Vector3<double>& p_world) const;
  bool refine(const Track& track, Vector3<double>& p_world, std::vector<double>& errors) const;

  PinholeCamera<double> camera_;
  SceneTrackSettings settings_;
  cv::Mat before_;
  std::vector<std::optional<Rigid<double>>> poses_;
  std::vector<Track> alive_;
  std::vector<Track> done_;
};

/// Adds scene points to the frames (true_T_world_camera must be there); returns how many. Reads all
/// pictures. Throws InputError as read_grey_image().
int add_scene_tracks(const PinholeCamera<double>& camera, const SceneTrackSettings& settings,
                     std::vector<SequenceFrame>& frames);

}  // namespace cairn::host
