#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/planar/tilt.hpp"
#include "cairn/tracking/rolling_shutter.hpp"

namespace cairn::host {

struct CameraFile {
  PinholeCamera<double> camera;
  /// Key `T_vehicle_camera` (16 numbers, row by row), where given.
  std::optional<Rigid<double>> T_vehicle_camera;
  /// Key `suspension` (flat, car, rover), where given: how the vehicle's body tilts.
  std::optional<TiltParameters<double>> tilt;
  /// Key `T_BS` (EuRoC), or `T_cam_imu` or `T_imu_cam` (Kalibr), where given: in the IMU's frame.
  std::optional<Rigid<double>> T_body_camera;
  /// Key `focal_sigma`, where given: relative standard deviation of the focal length.
  std::optional<double> focal_sigma;
  /// Keys `row_time` (also Kalibr's `line_delay`) and `column_time`, where given, s.
  ReadoutTimes readout;
  std::string format;  ///< which format it was read as
};

/// Whether read_camera_file() checks the lens: a part of the picture may be cut out first.
enum class LensCheck : std::uint8_t { kWholePicture, kLater };

/// Reads a calibration with radial-tangential, rational or fisheye distortion in one of these
/// formats, told apart by their keys: OpenCV (YAML, XML, JSON), ROS camera_info, Kalibr, EuRoC,
/// ORB-SLAM2 and 3, VINS, basalt, COLMAP's cameras.txt, plain (`fx`), Open EKF Mono SLAM and ViSP
/// JSON. docs/reference/camera-file.md shows each.
///
/// Throws InputError naming the key that is missing or wrong, for any other lens model and for
/// every coefficient that the core's camera has no place for, and for a camera that
/// check_camera() refuses.
CameraFile read_camera_file(const std::filesystem::path& path,
                            LensCheck lens = LensCheck::kWholePicture);

/// Refuses a camera that cannot be meant: a focal length below a tenth or above a hundred times the
/// longer side, two that differ by more than a factor of 3, a principal point outside the image, or
/// tangential coefficients above 0.02; and, as check_lens(), a lens. Throws InputError.
void check_camera(const PinholeCamera<double>& camera, const std::filesystem::path& path);

/// Refuses a distortion that folds inside the image, or a fisheye's ray beyond 80 degrees, naming
/// the pixel without a ray and the part that has them. Throws InputError.
void check_lens(const PinholeCamera<double>& camera, const std::filesystem::path& path);

}  // namespace cairn::host
