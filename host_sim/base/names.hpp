#pragma once

#include "cairn/base/ticks.hpp"
#include "cairn/tracking/frame_report.hpp"

namespace cairn::host {

/// Lower-case name of a state, for files and captions.
inline const char* to_string(TrackingState state) {
  switch (state) {
    case TrackingState::kInitialising:
      return "initialising";
    case TrackingState::kTracking:
      return "tracking";
    case TrackingState::kUncertain:
      return "uncertain";
    default:
      return "lost";
  }
}

/// Name of a reason for which a frame was not tracked, for files.
inline const char* to_string(NotTracked reason) {
  constexpr const char* kNames[kNotTrackedCount] = {"tracked",  "no_odometry", "no_new_image",
                                                    "no_work",  "no_corners",  "seeds_lost",
                                                    "no_depth", "not_found",   "no_consensus"};
  return kNames[static_cast<int>(reason)];
}

/// What it means that odometry turns `ratio` times as much as the pictures; 0: not known how much.
inline const char* meaning_of_yaw(double ratio) {
  if (ratio < -0.3) return "it has the wrong sign";
  if (ratio > 20.0 && ratio < 100.0) return "it is in degrees per second, not in radians";
  if (ratio > 2.0) return "it is many times too large";
  if (ratio > 0.0 && ratio < 0.3) return "it is many times too small";
  return "check its sign and its unit, rad/s";
}

/// A row of paper A's Table 1: its key in files, its name there, and its time on the paper's
/// desktop PC.
struct StageRow {
  const char* key;
  const char* name;
  double paper_iekf_ms;
  double paper_ekf_ms;
};

inline constexpr StageRow kStageRows[kStageCount] = {
    {"preprocess", "image preprocessing", 1.20, 1.20},
    {"pose_prediction", "camera pose estimation", 23.05, 19.26},
    {"features", "feature extraction and matching", 6.40, 6.40},
    {"pose_update", "camera pose calculation", 9.70, 9.70},
    {"render", "rendering and registration", 1.22, 1.22},
};
inline constexpr double kPaperTotalMs = 41.57;
inline constexpr double kPaperEkfTotalMs = 37.78;

}  // namespace cairn::host
