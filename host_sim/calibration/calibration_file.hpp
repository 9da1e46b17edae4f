#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/calibration/calibration.hpp"

namespace cairn::host {

/// What is wrong with a calibration, a sentence each with what to do about it; empty: it is good.
/// Asked for: 10 boards, a corner in half of the cells, an rms of 1 px (0.08 % of the longer side
/// of large pictures), fx known to 0.5 %.
std::vector<std::string> doubts_about(const Calibration& calibration, const Coverage& coverage);

/// Relative standard deviation of the focal length for the tracker: that of independent errors of
/// corners, and 0.5 % for what they do not show (a board that is not flat, focus that moved between
/// calibration and run). None for kFisheye, whose focal length is not estimated.
std::optional<double> focal_sigma_to_tell(const Calibration& calibration);

/// The camera file: a ROS camera_info in YAML, with key `focal_sigma` where it is known, and with
/// what else is known of its quality as comments. `how` is a line for the comment.
std::string camera_file_text(const Calibration& calibration, const Coverage& coverage,
                             const std::string& how);

/// The picture's cells, a line a row: '#' where a corner was seen, '.' elsewhere.
std::string drawn(const Coverage& coverage);

}  // namespace cairn::host
