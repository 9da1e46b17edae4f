#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

namespace cairn {

/// EkfSlam without floating point: the baseline, points on the plane alone. Interface and cost:
/// FixedPlanarSlam.
template <int MaxLandmarks>
using FixedEkfSlam = FixedPlanarSlam<MaxLandmarks, 2, FixedError::kWorld>;

}  // namespace cairn
