#pragma once

#include "host_sim/base/planar_types.hpp"

namespace cairn::host {

/// Normalised estimation error squared of (x, y, heading), additive coordinates, 3 degrees of
/// freedom.
double pose_nees(const PoseEstimate& estimate, const Pose2& truth);

/// The same for a landmark in world coordinates, 2 degrees of freedom.
double landmark_nees(const LandmarkEstimate& estimate, const Eigen::Vector2d& truth);

}  // namespace cairn::host
