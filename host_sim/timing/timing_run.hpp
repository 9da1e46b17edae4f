#pragma once

#include "host_sim/options/exit_code.hpp"
#include "host_sim/options/run_options.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// A run that is about to start.
struct TimedRun {
  FrameSource& source;
  Frame& first;  ///< taken from the source already
  Tracker& tracker;
  const TrackerOptions& tracker_options;
  const RunOptions& options;  ///< with `timing`
};

/// Runs all frames and reports their time alone: `frame_times.csv`, `frame_instructions.csv` (with
/// valgrind), `timing.json`, `timing.md` and `timing.png` in `options.out`, and a table beside the
/// paper's Table 1. kCheckFailed when the 99th percentile of the time on the core is above
/// `timing->p99_below_ms`.
ExitCode time_frames(const TimedRun& run);

}  // namespace cairn::host
