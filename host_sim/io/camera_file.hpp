#pragma once

#include <filesystem>
#include <optional>

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"

namespace cairn::host {

struct CameraFile {
  PinholeCamera<double> camera;
  /// Key `T_vehicle_camera` (16 numbers, row by row), where given.
  std::optional<Rigid<double>> T_vehicle_camera;
};

/// Reads a camera calibration in one of these dialects, told apart by their keys: OpenCV
/// (%YAML:1.0, `camera_matrix`), ROS camera_info, Kalibr (`cam0: intrinsics`), ORB-SLAM
/// (`Camera.fx`), plain (`fx`), Open EKF Mono SLAM (`CameraCalibration`), and ViSP JSON (`px`).
/// Throws InputError naming the key that is missing or wrong. docs/reference/camera-file.md shows
/// each.
CameraFile read_camera_file(const std::filesystem::path& path);

}  // namespace cairn::host
