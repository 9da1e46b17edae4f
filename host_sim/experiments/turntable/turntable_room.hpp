#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "host_sim/experiments/turntable/points_simulation.hpp"

namespace cairn::host {

/// The video of a turntable: a furnished room of 6 m x 3 m x 5.6 m around the rotation centre, seen
/// by the scenario's true camera along turntable_poses(scenario.motion). Grey, the size of the
/// scenario; the sensor adds noise of `noise_grey` grey values, blur and a slow change of exposure.
/// A function of scenario and seed alone.
std::vector<cv::Mat> render_turntable(const PointsScenario& scenario, double noise_grey);

}  // namespace cairn::host
