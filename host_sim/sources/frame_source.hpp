#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/planar/tilt.hpp"
#include "cairn/tracking/angular_rate.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/tracking/rolling_shutter.hpp"

#include "host_sim/sources/time_span.hpp"

namespace cairn::host {

/// A real point seen in a frame: the yardstick of the registration error. Never shown to a tracker.
struct ScenePointView {
  std::uint32_t id = 0;
  Vector2<double> pixel = Vector2<double>::Zero();     ///< where it truly is in the image
  Vector3<double> p_camera = Vector3<double>::Zero();  ///< its true place, camera frame, m
};

/// One frame of a source, with everything that is known about it.
struct Frame {
  int number = 0;         ///< as the source counts, may start anywhere
  std::int64_t t_us = 0;  ///< strictly increasing
  cv::Mat grey;           ///< 8 bit, one channel, continuous, of the camera's size
  cv::Mat colour;         ///< the same in BGR, to draw into; empty where the source gives none
  /// Samples since the frame before, t_us of the last one <= the frame's; of the first frame at
  /// most one, how the vehicle moves as it begins. Empty for handheld sources.
  std::vector<OdometrySample> odometry;
  /// A gyroscope's samples since the frame before, as odometry's. Empty where there is none.
  std::vector<AngularRateSample> gyro;
  std::optional<Rigid<double>> true_T_world_camera;
  std::optional<Rigid<double>> true_T_world_vehicle;
  std::vector<ScenePointView> scene_points;
};

/// What a source's odometry looks like; standard deviations of one sample.
struct OdometryModel {
  OdometrySample::Kind kind = OdometrySample::Kind::kTwist;
  double speed_sigma_mps = 0.0;
  double turn_sigma = 0.0;   ///< rad/s (kTwist) or rad (kAckermann)
  double wheelbase_m = 0.0;  ///< kAckermann alone
  double period_s = 0.1;     ///< nominal time between samples
};

struct SourceInfo {
  std::string name;  ///< hall, seven-scenes, ...
  PinholeCamera<double> camera;
  /// Relative standard deviation of the camera's focal length, where it is known.
  std::optional<double> focal_sigma;
  ReadoutTimes readout;  ///< of the pictures; 0: all pixels at once
  /// Where the camera sits on the vehicle; the identity for handheld sources.
  Rigid<double> T_vehicle_camera;
  std::optional<OdometryModel> odometry;  ///< absent: handheld
  std::optional<GyroParameters> gyro;     ///< of the frames' samples; absent: there are none
  /// The camera in the frame of its IMU, where its file says so.
  std::optional<Rigid<double>> T_body_camera;
  /// How the vehicle's body tilts, as far as the source knows.
  TiltParameters<double> tilt;
  double frame_rate_hz = 30.0;     ///< nominal
  std::optional<int> lap_frames;   ///< frames after which the path repeats, where it does
  std::optional<int> frame_count;  ///< frames that will come, where known
  std::uint64_t seed = 0;          ///< 0 where nothing is random
  /// Surfaces of the world that are known, convex polygons: what hides a virtual object. Vehicle
  /// mode alone, whose world is the true one.
  std::vector<std::vector<Vector3<double>>> surfaces;
  std::vector<std::filesystem::path> inputs;  ///< files that were read, for the manifest's hashes
  std::string note;                           ///< what was assumed, for the manifest and the report
  /// What the user should know of the inputs, complete after the last frame: for standard error,
  /// the summary and the manifest.
  std::vector<std::string> warnings;
  bool damaged = false;  ///< an input ended so early that it must be damaged; a warning says which
};

/// Frames in order, one at a time. Throws InputError where an input is unreadable or invalid.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const SourceInfo& info() const = 0;
  /// Fills `frame` (its storage is used again) and returns true, or returns false after the last.
  virtual bool next(Frame& frame) = 0;
  /// First and last time of the frames to come, where they are known before.
  virtual std::optional<TimeSpan> span() const { return std::nullopt; }

 protected:
  FrameSource() = default;
  FrameSource(const FrameSource&) = default;
  FrameSource& operator=(const FrameSource&) = default;
};

}  // namespace cairn::host
