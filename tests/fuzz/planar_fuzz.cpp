// The planar filters: every call with arbitrary values in any order.
#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

#include "planar_run.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace cairn;
  using namespace cairn::fuzz;
  return run_one_of<PlanarRun<GroupIekfSlam<float, kLandmarks, 3>>,
                    PlanarRun<LiftedIekfSlam<float, kLandmarks, 3>>,
                    PlanarRun<EkfSlam<float, kLandmarks, 3>>>(bytes, size, kPlanarSteps);
}
