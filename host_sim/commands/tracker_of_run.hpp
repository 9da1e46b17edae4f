#pragma once

#include "host_sim/options/run_options.hpp"
#include "host_sim/sources/frame_source.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// As the options say, else by whether the source has odometry. UsageError where it needs some.
Mode mode_of(const RunOptions& options, const SourceInfo& source);

/// The tracker that a run asks for, which starts at the true pose of `first` where that is known.
/// UsageError for an option that mode or filter has no use for.
TrackerOptions tracker_options(const RunOptions& options, const SourceInfo& source,
                               const Frame& first);

}  // namespace cairn::host
