// VehicleTracker: calls with arbitrary values in any order.
#include "cairn/planar/group_iekf_slam.hpp"

#include "vehicle_run.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn;
  using namespace cairn::fuzz;
  return run_from_start<VehicleRun<GroupIekfSlam<float, SmallConfig::kMaxLandmarks, 3>>>(
      bytes, size, kWarmFrames, kTrackerSteps);
}
