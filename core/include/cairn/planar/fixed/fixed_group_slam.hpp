#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

namespace cairn {

/// GroupIekfSlam without floating point. Interface and cost: FixedPlanarSlam.
template <int MaxLandmarks, int LandmarkDim = 2>
using FixedGroupSlam = FixedPlanarSlam<MaxLandmarks, LandmarkDim, FixedError::kGroup>;

}  // namespace cairn
