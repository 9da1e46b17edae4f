#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/trackers/handheld_adapter.hpp"
#include "host_sim/trackers/vehicle_adapter.hpp"

namespace cairn::host {

std::unique_ptr<Tracker> make_tracker(const TrackerOptions& options, const SourceInfo& source) {
  if (options.mode == Mode::kHandheld) {
    if (!options.filter.empty() && options.filter != "mono") {
      throw UsageError(fmt::format("--filter {}: handheld mode runs with mono", options.filter));
    }
    return make_handheld_tracker(options, source);
  }
  if (options.filter == "mono") {
    throw UsageError("--filter mono: vehicle mode runs with group-iekf, lifted-iekf or ekf");
  }
  if (!source.odometry) {
    throw UsageError(fmt::format("--mode vehicle: source {} has no odometry", source.name));
  }
  return make_vehicle_tracker(options, source);
}

}  // namespace cairn::host
