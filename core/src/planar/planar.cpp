// Instantiates the planar filters once inside the core, so that its rules (warnings as errors, no
// double in float code, no heap) hold for their templates too.
#include "cairn/base/config.hpp"
#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

namespace cairn {

template class PlanarSlam<WorldErrorModel<float, DefaultConfig::kMaxLandmarks, 3>>;
template class PlanarSlam<WorldErrorModel<double, DefaultConfig::kMaxLandmarks, 2>>;
template class PlanarSlam<GroupErrorModel<float, DefaultConfig::kMaxLandmarks, 3>>;
template class PlanarSlam<GroupErrorModel<double, DefaultConfig::kMaxLandmarks, 2>>;
template class PlanarSlam<LiftedErrorModel<float, TinyConfig::kMaxLandmarks, 3>>;
template class PlanarSlam<LiftedErrorModel<double, TinyConfig::kMaxLandmarks, 2>>;
template class LiftedIekfSlam<float, TinyConfig::kMaxLandmarks, 3>;
template class LiftedIekfSlam<double, TinyConfig::kMaxLandmarks, 2>;

}  // namespace cairn
