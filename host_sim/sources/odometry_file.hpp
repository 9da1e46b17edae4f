#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

struct OdometryFile {
  OdometryModel model;
  std::vector<OdometrySample> samples;  ///< two or more, times strictly increasing
  std::string warning;                  ///< what of the file is not used; empty: nothing
};

/// Reads odometry (CSV): a time, a speed, and a yaw rate or, where there is none, a steering angle
/// with the wheelbase; columns and units as in docs/reference/command-line.md.
///
/// Throws InputError naming line and column for a sample outside the domain: |speed| <= 100 m/s,
/// |yaw rate| <= 10 rad/s, |steering| <= 1.4 rad, wheelbase above 0 and at most 20 m and the same
/// in every row, a turn of at most 3.14 rad since the row before; and for times that do not
/// increase.
OdometryFile read_odometry(const std::filesystem::path& path);

/// Appends the samples from `next` on, up to the frame's time, to the frame's odometry, and counts
/// `next` on. Of those before the first frame only the newest, where it is at most 0.2 s old: how
/// fast the vehicle comes.
void take_samples(const std::vector<OdometrySample>& samples, bool first_frame, std::size_t& next,
                  Frame& frame);

}  // namespace cairn::host
