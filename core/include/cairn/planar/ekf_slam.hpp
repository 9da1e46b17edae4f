#pragma once

#include "cairn/planar/error_model/world.hpp"
#include "cairn/planar/planar_slam.hpp"

namespace cairn {

/// Plain EKF-SLAM in the plane (Smith, Self, Cheeseman 1990; paper A's yardstick): state (x, y,
/// heading, landmarks), linearised at the latest estimate. It gains heading information that no
/// measurement holds, so its covariance becomes too small: the baseline, not the default.
///
/// T is float or double; LandmarkDim 2 (points on the plane) or 3 (with height, for the camera).
/// Interface: PlanarSlam. Cost: prediction O(n) each.
template <class T, int MaxLandmarks, int LandmarkDim = 2, int TiltStates = LandmarkDim == 3 ? 2 : 0>
using EkfSlam = PlanarSlam<WorldErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates>>;

}  // namespace cairn
