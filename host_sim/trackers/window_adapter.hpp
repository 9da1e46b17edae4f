#pragma once

#include <memory>

#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// The core's WindowTracker (KeyframeWindow) as the runner sees it.
std::unique_ptr<Tracker> make_window_tracker(const TrackerOptions& options,
                                             const SourceInfo& source);

}  // namespace cairn::host
