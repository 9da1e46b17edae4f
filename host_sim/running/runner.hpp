#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cairn/runtime/health_monitor.hpp"

#include "host_sim/base/names.hpp"
#include "host_sim/evaluation/registration_error.hpp"
#include "host_sim/sources/frame_source.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// Everything that is kept of a frame.
struct FrameRecord {
  int number = 0;
  FrameReport report;
  double stage_ms[kStageCount] = {};
  double total_ms = 0.0;  ///< wall time of the tracker's call
  std::optional<PlanarPoseEstimate> vehicle;
  std::optional<Rigid<double>> true_T_world_camera;
  std::optional<Rigid<double>> true_T_world_vehicle;
  std::vector<LandmarkId> measured;
  /// 3 degrees of freedom: of the vehicle's planar pose, or of a hand-held camera's attitude
  /// against that of the first frame with a pose.
  std::optional<double> nees;
  std::optional<double> filter_nees;  ///< by the filter's own covariance
  double core_ms = 0.0;               ///< of total_ms, without the time of other programs
  float health_score = 0.0F;          ///< of HealthMonitor
  Health health;                      ///< counters after the frame
  /// Of the pose, where there is one: as Tracker::position_covariance(), and of the heading or of
  /// an axis of a hand-held camera's attitude.
  std::optional<Matrix3<double>> position_covariance;
  double attitude_sigma_rad = 0.0;

  bool has_pose() const {
    return report.state == TrackingState::kTracking || report.state == TrackingState::kUncertain;
  }
  /// Whether the image determined the pose.
  bool is_measured() const { return has_pose() && report.not_tracked == NotTracked::kTracked; }
};

struct RunRecord {
  std::vector<FrameRecord> frames;
  std::vector<RegistrationInput> registration_input;
  std::vector<MapLandmark> landmarks;
  int landmark_capacity = 0;
  int library_size = -1;
  std::optional<int> lap_frames;
  Health health;
  std::optional<MountOffset> mount;
  std::optional<GroundCheck> ground;
  std::optional<FocalScale> focal;
  std::optional<YawCheck> yaw;
  std::optional<DirectionOfTravel<float>> travel;
  std::optional<GyroReport> gyro;
  std::optional<int> mount_suspect_frame;  ///< index in `frames` of the first with a suspicion
  std::vector<HealthRecord> events;        ///< the last ones, the newest first
  nlohmann::json tracker;
  std::uint64_t log_hash = 0;
  int interrupted_by = 0;                       ///< signal after which no frame was begun, else 0
  bool ended_by_viewer = false;                 ///< in the window
  std::filesystem::path overlay;                ///< empty without video
  std::vector<std::filesystem::path> pictures;  ///< overlay frames for the report
};

struct RunnerSettings {
  std::filesystem::path out;
  bool video = true;
  bool shaded = false;   ///< objects with shaded faces, hidden by known surfaces, not as wireframes
  int pictures = 6;      ///< overlay frames kept for the report
  bool progress = true;  ///< shown where standard error is a terminal
  bool view = false;     ///< shown in a window, which may end the run
  double budget_ms = kPaperTotalMs;  ///< of a frame, for the window
};

/// Drives `tracker` over `first` and the rest of `source`. Writes the overlay video and its
/// pictures into `settings.out`; ends early where a signal came (InterruptionGuard); shows progress
/// where standard error is a terminal.
RunRecord run_frames(FrameSource& source, Frame& first, Tracker& tracker,
                     const RunnerSettings& settings);

}  // namespace cairn::host
