#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "host_sim/io/pose_file.hpp"
#include "host_sim/sources/frame_source.hpp"
#include "host_sim/sources/time_span.hpp"

namespace cairn::host {

/// The pose of a recording nearest to `t_us`; none further than 20 ms. `poses` are in time order.
std::optional<Rigid<double>> pose_near(const std::vector<TimedPose>& poses, std::int64_t t_us);

/// check_overlap() of true poses that were read from `path`; its warning goes into `info`.
void check_truth(const std::filesystem::path& path, const std::vector<TimedPose>& truth,
                 const TimeSpan& frames, SourceInfo& info);

}  // namespace cairn::host
