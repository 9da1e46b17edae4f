#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include <opencv2/core.hpp>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/sources/frame_source.hpp"
#include "host_sim/sources/image_sequence.hpp"

namespace cairn::host {

struct VideoOptions {
  std::filesystem::path media;     ///< a video file, or a folder of numbered images
  bool live = false;               ///< `media` is a camera, as open_camera() takes it
  std::filesystem::path camera;    ///< camera file; this or `hfov_deg`
  std::filesystem::path odometry;  ///< CSV, optional: turns the source into a vehicle's
  std::filesystem::path times;     ///< CSV, optional
  std::filesystem::path truth;     ///< TUM, optional: camera poses
  /// Points of the scene, triangulated with `truth`, as the yardstick of the registration error.
  /// All pictures are read once before the first frame.
  bool scene_points = false;
  FrameRange range;
  bool colour = false;                         ///< frames have their colours, where the media does
  std::optional<double> speed_sigma_mps;       ///< of an odometry sample; absent: as for any wheels
  std::optional<double> yaw_rate_sigma_radps;  ///< same; only for odometry with a yaw rate
  std::optional<double> hfov_deg;              ///< the camera is guessed; a warning says so
  LensCheck lens = LensCheck::kWholePicture;   ///< kLater where the pictures are cropped
};

/// A camera of which nothing is known but the horizontal field of view of its pictures, degrees: no
/// distortion, square pixels, the principal point in the middle.
PinholeCamera<double> guessed_camera(const cv::Size& size, double hfov_deg);

/// A video of your own. Times come from `times`, else from the pictures' names or the video's
/// container, else 30 Hz. docs/reference/command-line.md describes the files and what is checked.
///
/// Throws InputError naming the file for an input that is invalid, that does not fit the camera, or
/// that is not of the frames' time; UsageError without a camera or with two, for a noise of what
/// the odometry does not have, and for scene points of a live camera or without true poses.
/// Recordings that cover a part of the frames, and a video that ends early, are told by
/// info().warnings and info().damaged.
std::unique_ptr<FrameSource> make_video_source(const VideoOptions& options);

}  // namespace cairn::host
