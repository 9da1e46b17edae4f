#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_sim/sources/frame_source.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// One lap of a long run. Errors are of the vehicle's position on the floor, m.
struct LapResult {
  int lap = 0;  ///< from 1
  int frames = 0;
  int tracked = 0;  ///< state tracking
  int lost = 0;
  double map_rms_m = 0.0;  ///< of the reported pose, in the map's frame
  double map_worst_m = 0.0;
  double sigma_m = 0.0;  ///< that is stated of it, mean over the lap
  double nees = 0.0;     ///< of the reported pose, 3 degrees of freedom, mean
  double worst_nees = 0.0;
  double filter_rms_m = 0.0;    ///< of the filter's pose, in its own world
  double filter_sigma_m = 0.0;  ///< that the filter states, mean over the lap
  double filter_nees = 0.0;     ///< of the filter's pose and covariance, mean
  int library = 0;
  double memory_mb = 0.0;  ///< resident set of the process at the lap's end
  double frame_ms = 0.0;   ///< processor time of the tracker, mean
};

/// Tracks `source`, whose path repeats every `source.info().lap_frames`, lap by lap until it ends
/// or a signal came (InterruptionGuard). `done` gets each lap as it ends; one that is cut is not
/// counted. Throws InputError where the source has no truth or no laps.
std::vector<LapResult> run_laps(FrameSource& source, const TrackerOptions& options,
                                const std::function<void(const LapResult&)>& done);

std::string laps_header();                   ///< of laps.csv
std::string laps_row(const LapResult& lap);  ///< a line of it

}  // namespace cairn::host
