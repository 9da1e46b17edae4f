#pragma once

#include <filesystem>
#include <memory>

#include "host_sim/sources/frame_source.hpp"
#include "host_sim/sources/image_sequence.hpp"

namespace cairn::host {

struct VideoOptions {
  std::filesystem::path media;     ///< a video file, or a folder of numbered images
  std::filesystem::path camera;    ///< camera file, required
  std::filesystem::path odometry;  ///< CSV, optional: turns the source into a vehicle's
  std::filesystem::path times;     ///< CSV, optional
  std::filesystem::path truth;     ///< TUM, optional: camera poses
  FrameRange range;
};

/// A video of your own. Times come from `times` (columns `frame` and `t_us` or `t_s`), else from
/// the video's own rate, else 30 Hz. Odometry: columns `t_us` or `t_s`, `speed_mps`, and
/// `yaw_rate_radps` or `steering_rad` with `wheelbase_m`. Throws InputError, and UsageError without
/// a camera.
std::unique_ptr<FrameSource> make_video_source(const VideoOptions& options);

}  // namespace cairn::host
