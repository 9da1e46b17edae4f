#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "host_sim/io/camera_file.hpp"
#include "host_sim/sources/frame_source.hpp"
#include "host_sim/sources/image_sequence.hpp"

namespace cairn::host {

/// Recorded data sets in the folders' own formats. Each throws InputError naming file, line and
/// what was expected. docs/reference/command-line.md lists the files.

/// 7-Scenes: `frame-N.color.png|jpg` with `frame-N.pose.txt`, 30 Hz; the camera is `camera_file`
/// or, when that is empty, the one of its authors, fx = fy = 520, 640x480.
std::unique_ptr<FrameSource> make_seven_scenes_source(const std::filesystem::path& folder,
                                                      const std::filesystem::path& camera_file,
                                                      const FrameRange& range,
                                                      LensCheck lens = LensCheck::kWholePicture);

/// Desk with an AprilTag board: `gray/N.png`, `cam.json`, `cMo_grid.csv`, `tag_corners.csv`. The
/// world is the board; the tags' corners are the scene points. The rate is not stated: 30 Hz.
std::unique_ptr<FrameSource> make_tag_board_source(const std::filesystem::path& folder,
                                                   const FrameRange& range);

/// KITTI odometry: `image_0`, `image_l` or `image_2`, `calib.txt`, `times.txt` where there is one
/// (10 Hz otherwise), and poses from `poses.txt` or, as downloaded, `../../poses/NN.txt`. Vehicle
/// mode: the vehicle's origin is on the ground below the IMU, 1.08 m behind, 0.32 m left of
/// and 1.65 m below camera 0; odometry (speed and yaw rate) is derived from the poses with noise of
/// 0.1 m/s and 0.01 rad/s, drawn by `seed`. Without poses, as the sequences from 11 on are:
/// hand-held mode.
std::unique_ptr<FrameSource> make_kitti_source(const std::filesystem::path& folder,
                                               const FrameRange& range, std::uint64_t seed);

/// TUM RGB-D: `rgb.txt`, `groundtruth.txt`; the camera is `camera_file` or, when that is empty, the
/// one published for the freiburg number in the folder's name. Frames are numbered from 0.
std::unique_ptr<FrameSource> make_tum_rgbd_source(const std::filesystem::path& folder,
                                                  const std::filesystem::path& camera_file,
                                                  const FrameRange& range,
                                                  LensCheck lens = LensCheck::kWholePicture);

/// EuRoC and TUM-VI as downloaded: `mav0/cam0/data.csv` (times in ns), `mav0/cam0/data/`, and true
/// poses of the body from `mav0/state_groundtruth_estimate0` or `mav0/mocap0` where they are. The
/// camera and its place on the body are those of `camera_file`, `mav0/cam0/sensor.yaml` or
/// `dso/camchain.yaml`, the first that there is. `folder` may also be mav0 itself. Frames are
/// numbered from 0.
std::unique_ptr<FrameSource> make_euroc_source(const std::filesystem::path& folder,
                                               const std::filesystem::path& camera_file,
                                               const FrameRange& range,
                                               LensCheck lens = LensCheck::kWholePicture);

/// A drive of KITTI's raw data: `image_00` (or `image_02`) and `oxts` with their timestamps.txt,
/// and in the folder or above it calib_cam_to_cam.txt, calib_velo_to_cam.txt and
/// calib_imu_to_velo.txt. Synchronised and rectified drives, and unrectified ones (`_extract`).
/// Vehicle mode: odometry is the forward speed and the yaw rate of oxts, the truth its pose; the
/// vehicle's origin is on the ground, 0.93 m below the IMU.
std::unique_ptr<FrameSource> make_kitti_raw_source(const std::filesystem::path& folder,
                                                   const FrameRange& range);
/// Whether `folder` is such a drive.
bool is_kitti_raw(const std::filesystem::path& folder);

}  // namespace cairn::host
