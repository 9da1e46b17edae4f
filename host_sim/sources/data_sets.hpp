#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "host_sim/sources/frame_source.hpp"
#include "host_sim/sources/image_sequence.hpp"

namespace cairn::host {

/// Recorded data sets in the folders' own formats. Each throws InputError naming file, line and
/// what was expected. docs/reference/command-line.md lists the files.

/// 7-Scenes: `frame-N.color.png|jpg` with `frame-N.pose.txt`; fx = fy = 520, 640x480, 30 Hz.
std::unique_ptr<FrameSource> make_seven_scenes_source(const std::filesystem::path& folder,
                                                      const FrameRange& range);

/// Desk with an AprilTag board: `gray/N.png`, `cam.json`, `cMo_grid.csv`, `tag_corners.csv`. The
/// world is the board; the tags' corners are the scene points. The rate is not stated: 30 Hz.
std::unique_ptr<FrameSource> make_tag_board_source(const std::filesystem::path& folder,
                                                   const FrameRange& range);

/// KITTI odometry: `image_l` or `image_0`, `calib.txt`, `poses.txt`, `times.txt` where there is one
/// (10 Hz otherwise). Vehicle mode: the vehicle is below the camera, 1.65 m; odometry (speed and
/// yaw rate) is derived from the poses with noise of 0.1 m/s and 0.01 rad/s, drawn by `seed`.
std::unique_ptr<FrameSource> make_kitti_source(const std::filesystem::path& folder,
                                               const FrameRange& range, std::uint64_t seed);

/// TUM RGB-D: `rgb.txt`, `groundtruth.txt`; the camera is `camera_file` or, when that is empty, the
/// one published for the freiburg number in the folder's name. Frames are numbered from 0.
std::unique_ptr<FrameSource> make_tum_rgbd_source(const std::filesystem::path& folder,
                                                  const std::filesystem::path& camera_file,
                                                  const FrameRange& range);

}  // namespace cairn::host
