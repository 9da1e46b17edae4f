#pragma once

#include <cstdint>
#include <memory>

#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// Relative standard deviation of the focal length that the tracker is told, in 1/10,000.
std::uint16_t window_focal_sigma_e4(const HandheldOptions& options, const SourceInfo& source);

/// How the window is told that the pictures are read out. Throws UsageError for a row time that
/// takes too long.
ReadoutTimes window_readout(const HandheldOptions& options, const SourceInfo& source);

/// The core's WindowTracker (KeyframeWindow) as the runner sees it.
std::unique_ptr<Tracker> make_window_tracker(const TrackerOptions& options,
                                             const SourceInfo& source);

}  // namespace cairn::host
