// VehicleTracker with the filter without floating point: calls with arbitrary values in any order.
#include "cairn/planar/fixed/fixed_vehicle_slam.hpp"

#include "vehicle_run.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn;
  using namespace cairn::fuzz;
  return run_from_start<VehicleRun<FixedVehicleSlam<SmallConfig::kMaxLandmarks>>>(
      bytes, size, kWarmFrames, kTrackerSteps);
}
