#pragma once

#include <memory>

#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// The core's VehicleTracker with the planar filter that `options.filter` names, as the runner sees
/// it.
std::unique_ptr<Tracker> make_vehicle_tracker(const TrackerOptions& options,
                                              const SourceInfo& source);

}  // namespace cairn::host
