#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/io/pose_file.hpp"
#include "host_sim/sources/frame_source.hpp"
#include "host_sim/sources/time_span.hpp"

namespace cairn::host {

/// The pose of a recording nearest to `t_us`; none further than 20 ms. `poses` are in time order.
std::optional<Rigid<double>> pose_near(const std::vector<TimedPose>& poses, std::int64_t t_us);

/// A warning where true poses that were read from `path` move faster than 300 m/s.
std::optional<std::string> check_steps(const std::filesystem::path& path,
                                       const std::vector<TimedPose>& truth);

/// check_overlap() and check_steps() of true poses; their warnings go into `info`.
void check_truth(const std::filesystem::path& path, const std::vector<TimedPose>& truth,
                 const TimeSpan& frames, SourceInfo& info);

}  // namespace cairn::host
