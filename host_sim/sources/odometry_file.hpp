#pragma once

#include <filesystem>
#include <vector>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

struct OdometryFile {
  OdometryModel model;
  std::vector<OdometrySample> samples;  ///< two or more, times strictly increasing
};

/// Reads odometry (CSV): a time, a speed, and a yaw rate or, where there is none, a steering angle
/// with the wheelbase; columns and units as in docs/reference/command-line.md.
///
/// Throws InputError naming line and column for a sample outside the domain: |speed| <= 100 m/s,
/// |yaw rate| <= 10 rad/s, |steering| <= 1.4 rad, wheelbase above 0 and at most 20 m and the same
/// in every row, a turn of at most 3.14 rad since the row before; and for times that do not
/// increase.
OdometryFile read_odometry(const std::filesystem::path& path);

}  // namespace cairn::host
