#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "host_sim/running/runner.hpp"

namespace cairn::host {

/// What a window shows of a frame: `picture` (BGR, of the camera's size, objects drawn) with the
/// frame's FAST corners (grey), and for each landmark in view the 3-sigma ellipse in which the map
/// expects it, green where the frame measured it and amber where it did not; below it the five
/// stages and the whole frame as bars against their budgets, the state, and the keys.
cv::Mat view_picture(const cv::Mat& picture, const cv::Mat& grey, const FrameRecord& entry,
                     const std::vector<MapLandmark>& landmarks, const PinholeCamera<double>& camera,
                     double budget_ms);

}  // namespace cairn::host
