// FixedVehicleSlam, the trackers' messages before a filter without floating point: every call with
// arbitrary values in any order.
#include "planar_run.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn;
  using namespace cairn::fuzz;
  count_allocations();
  Input input(bytes, size);
  run_steps<PlanarRun<FixedVehicleSlam<kLandmarks>>>(input, kPlanarSteps);
  return 0;
}
