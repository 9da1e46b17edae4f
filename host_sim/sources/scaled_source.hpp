#pragma once

#include <memory>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// Shrinks the pictures of `source` by `factor` (0 < factor < 1, cv::INTER_AREA) and its
/// calibration and scene points with them: sides are rounded to whole pixels, and focal lengths and
/// principal point follow exactly. Throws InputError where a side would be less than 16 pixels.
std::unique_ptr<FrameSource> scale_source(std::unique_ptr<FrameSource> source, double factor);

/// The factor that makes pictures of `camera` fit into max_width x max_height; 1 where they do.
double fitting_factor(const PinholeCamera<double>& camera, int max_width, int max_height);

}  // namespace cairn::host
