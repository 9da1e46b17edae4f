#include "host_sim/trackers/handheld_adapter.hpp"
#include "host_sim/trackers/vehicle_adapter.hpp"

namespace cairn::host {

std::unique_ptr<Tracker> make_tracker(const TrackerOptions& options, const SourceInfo& source) {
  return options.mode == Mode::kHandheld ? make_handheld_tracker(options, source)
                                         : make_vehicle_tracker(options, source);
}

}  // namespace cairn::host
