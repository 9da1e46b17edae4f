#include "host_sim/trackers/handheld_adapter.hpp"
#include "host_sim/trackers/vehicle_adapter.hpp"
#include "host_sim/trackers/window_adapter.hpp"

namespace cairn::host {

std::unique_ptr<Tracker> make_tracker(const TrackerOptions& options, const SourceInfo& source) {
  if (options.mode == Mode::kVehicle) return make_vehicle_tracker(options, source);
  return options.filter == kWindowFilter ? make_window_tracker(options, source)
                                         : make_handheld_tracker(options, source);
}

}  // namespace cairn::host
