#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "cairn/ar/augmenter.hpp"
#include "cairn/base/health.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/geometry/focal_scale.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/planar/tilt.hpp"
#include "cairn/planar/types.hpp"
#include "cairn/tracking/frame_report.hpp"
#include "cairn/tracking/ground_check.hpp"
#include "cairn/tracking/handheld_gyro.hpp"
#include "cairn/tracking/mount_evidence.hpp"
#include "cairn/tracking/yaw_check.hpp"

#include "host_sim/options/handheld_options.hpp"
#include "host_sim/options/run_options.hpp"
#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// A landmark as the host writes it down, in the map's frame.
struct MapLandmark {
  LandmarkId id = kNoLandmark;
  Vector3<double> p_map = Vector3<double>::Zero();
  Matrix3<double> covariance = Matrix3<double>::Zero();
  bool active = false;  ///< in the filter; otherwise archived in the library
};

/// Planar pose of the vehicle with its covariance in (x, y, theta), additive coordinates.
struct PlanarPoseEstimate {
  double x_m = 0.0;
  double y_m = 0.0;
  double theta_rad = 0.0;
  Matrix3<double> covariance = Matrix3<double>::Zero();         ///< systematic errors included
  Matrix3<double> filter_covariance = Matrix3<double>::Zero();  ///< the filter's own
  /// Of the pose in the map, in its axes; systematic errors included.
  Matrix3<double> map_covariance = Matrix3<double>::Zero();
  Matrix3<double> in_map_covariance = Matrix3<double>::Zero();  ///< beside the map's own error
};

/// What the runner drives: the core's tracker behind one face for both modes.
class Tracker {
 public:
  virtual ~Tracker() = default;
  /// One frame with the odometry before it. `overlay` is an 8-bit grey copy of the frame: the
  /// virtual object is drawn into it (stage kRender). Ticks in `report` are those of host_ticks().
  /// The Status is the report's own.
  virtual Status process(const Frame& frame, cv::Mat& overlay, FrameReport& report) = 0;
  /// One sample outside of process(). kInvalidArgument in handheld mode, which takes none.
  virtual Status add_odometry(const OdometrySample& /*sample*/) { return Status::kInvalidArgument; }
  /// Units of work that each frame may take from now on. The core's trackers alone.
  virtual Status set_work_limit(int /*units*/) { return Status::kInvalidArgument; }
  /// A tracker in the same state that goes its own way from here. The core's trackers alone, others
  /// give null.
  virtual std::unique_ptr<Tracker> clone() const { return nullptr; }
  /// Fingerprint of the estimate: pose, covariance, landmarks, state. The core's trackers alone.
  virtual std::uint64_t state_hash() const { return 0; }
  virtual std::vector<MapLandmark> landmarks() const = 0;
  virtual int landmark_capacity() const = 0;
  /// Landmarks that the last frame measured.
  virtual std::vector<LandmarkId> measured() const { return {}; }
  /// Landmarks in the map library, -1 without one.
  virtual int library_size() const { return -1; }
  virtual Health health() const = 0;
  /// The virtual objects that process() draws; null where there are none.
  virtual const Augmenter* objects() const { return nullptr; }
  /// How far mount and focal length seem to be off. Vehicle mode alone.
  virtual std::optional<MountOffset> mount_offset() const { return std::nullopt; }
  /// The focal length as a factor on what the tracker was told, where it is estimated.
  virtual std::optional<FocalScale> focal_scale() const { return std::nullopt; }
  /// What is known of the gyroscope, where samples came. The window of keyframes alone.
  virtual std::optional<GyroReport> gyro() const { return std::nullopt; }
  /// Whether speed and camera height fit the height of the ground. Vehicle mode alone.
  virtual std::optional<GroundCheck> ground() const { return std::nullopt; }
  /// Whether odometry turns as the pictures do. Vehicle mode alone.
  virtual std::optional<YawCheck> yaw() const { return std::nullopt; }
  /// How far the vehicle travels beside the axis that the mount says, where that is estimated.
  virtual std::optional<DirectionOfTravel<float>> travel() const { return std::nullopt; }
  /// Vehicle mode alone.
  virtual std::optional<PlanarPoseEstimate> vehicle_pose() const { return std::nullopt; }
  /// Covariance of the attitude, rad^2, camera axes; of a small turn after it. Handheld mode alone.
  virtual std::optional<Matrix3<double>> attitude_covariance() const { return std::nullopt; }
  /// Covariance of the position that the trajectory files hold, in their frame, m^2: of a vehicle
  /// (in the plane) or of a hand-held camera.
  virtual std::optional<Matrix3<double>> position_covariance() const { return std::nullopt; }
  /// Filter, mode and configuration, for the manifest.
  virtual nlohmann::json description() const = 0;

 protected:
  Tracker() = default;
  Tracker(const Tracker&) = default;
  Tracker& operator=(const Tracker&) = default;
};

enum class Mode : std::uint8_t { kVehicle, kHandheld };

struct TrackerOptions {
  Mode mode = Mode::kVehicle;
  std::string filter =
      kDefaultVehicleFilter;  ///< group-iekf(-fixed), lifted-iekf, ekf; handheld: mono, window
  std::string fading;         ///< a number, adaptive, or empty for the filter's own
  double budget_ms = kDefaultBudgetMs;
  std::uint64_t seed = 1;
  HandheldOptions handheld;
  std::optional<int> work_limit;  ///< units a frame; empty: the tracker's own
  /// Vehicle mode: where the estimate starts, with its variances (x and y alike; heading).
  double start_x_m = 0.0;
  double start_y_m = 0.0;
  double start_theta_rad = 0.0;
  double start_position_variance = kKnownStartVariance;
  double start_heading_variance = kKnownStartVariance;
  TiltParameters<double> tilt;  ///< of the vehicle's body
  /// Of the direction of travel, group-iekf alone; empty: the tracker's own.
  std::optional<double> travel_sigma_rad;
};

/// The core's tracker for `options` on a source. Domain: filter and mode go together, and a source
/// of mode kVehicle has odometry. Throws InputError when the tracker refuses the source's camera.
std::unique_ptr<Tracker> make_tracker(const TrackerOptions& options, const SourceInfo& source);

}  // namespace cairn::host
