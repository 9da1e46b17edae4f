#pragma once

#include "cairn/planar/error_model/group.hpp"
#include "cairn/planar/planar_slam.hpp"

namespace cairn {

/// The default planar filter: paper A's lifted filter reduced exactly and kept on its constraint
/// surface, which makes it the right-invariant EKF (docs/explanation/iekf-slam.md).
/// - The rows of a measurement act on landmark minus vehicle alone, the transition is the identity:
///   no information enters the directions that nothing measures.
/// - Odometry noise is gathered, O(1) per odometry step and exact, and reaches the landmarks in the
///   first pass of the next update.
/// - A correction moves pose and landmarks by one exponential of the group.
/// - pose(), landmark_position() and their covariances are exact trigonometric moments of the
///   Gaussian error. The position of pose() lies nearer to the first estimate than mean_pose()'s by
///   the factor exp(-heading variance / 2).
///
/// TravelStates 1: the direction of travel can be a state (PlanarParameters::travel_sigma_rad).
/// T is float or double; LandmarkDim 2 (points on the plane) or 3 (with height, for the camera).
/// Interface: PlanarSlam.
template <class T, int MaxLandmarks, int LandmarkDim = 2, int TiltStates = LandmarkDim == 3 ? 2 : 0,
          int TravelStates = detail::travel_states(MaxLandmarks, LandmarkDim)>
using GroupIekfSlam =
    PlanarSlam<GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>>;

}  // namespace cairn
