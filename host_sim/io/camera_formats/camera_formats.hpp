#pragma once

#include <filesystem>
#include <string>

#include "cairn/geometry/camera.hpp"

#include "host_sim/io/camera_formats/camera_section.hpp"

namespace cairn::host {

/// A format of camera files: how it is told, and its reader. One file each.
struct CameraFormat {
  const char* name;  ///< as in docs/reference/camera-file.md
  const char* told_by;
  bool (*matches)(const CameraSection& root);
  /// Throws InputError naming the key that is missing or wrong.
  PinholeCamera<double> (*read)(const CameraSection& root);
};

extern const CameraFormat kOpenCvFormat;   ///< also ROS camera_info
extern const CameraFormat kKalibrFormat;   ///< also EuRoC's sensor.yaml
extern const CameraFormat kOrbSlamFormat;  ///< ORB-SLAM2 and ORB-SLAM3
extern const CameraFormat kPlainFormat;    ///< fx, fy, cx, cy
extern const CameraFormat kVinsFormat;     ///< VINS-Mono, VINS-Fusion, camodocal
extern const CameraFormat kBasaltFormat;
extern const CameraFormat kMonoSlamFormat;  ///< Open EKF Mono SLAM
extern const CameraFormat kVispFormat;

/// COLMAP's cameras.txt is no tree of keys: told by its text.
bool is_colmap_text(const std::string& text);
/// Throws InputError naming the line. Its pixel (0.5, 0.5) is the centre of the first pixel, here
/// it is (0, 0): half a pixel is taken off.
PinholeCamera<double> read_colmap(const std::filesystem::path& path);

}  // namespace cairn::host
