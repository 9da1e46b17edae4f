#include "host_sim/sources/true_poses.hpp"

#include <algorithm>
#include <cstdlib>

#include <fmt/format.h>

namespace cairn::host {

std::optional<Rigid<double>> pose_near(const std::vector<TimedPose>& poses, std::int64_t t_us) {
  constexpr std::int64_t kLargestTimeDifference_us = 20000;
  const auto after =
      std::lower_bound(poses.begin(), poses.end(), t_us,
                       [](const TimedPose& p, std::int64_t t) { return p.t_us < t; });
  std::optional<Rigid<double>> best;
  std::int64_t best_difference = kLargestTimeDifference_us + 1;
  for (const auto it : {after, after == poses.begin() ? after : after - 1}) {
    if (it == poses.end()) continue;
    const std::int64_t difference = std::abs(it->t_us - t_us);
    if (difference < best_difference) {
      best_difference = difference;
      best = it->pose;
    }
  }
  return best;
}

std::optional<std::string> check_steps(const std::filesystem::path& path,
                                       const std::vector<TimedPose>& truth) {
  constexpr double kMostSpeed_mps = 300.0;
  for (std::size_t i = 1; i < truth.size(); ++i) {
    const double step_s = 1e-6 * static_cast<double>(truth[i].t_us - truth[i - 1].t_us);
    const double step_m = (truth[i].pose.translation - truth[i - 1].pose.translation).norm();
    if (step_m <= kMostSpeed_mps * step_s) continue;
    return fmt::format(
        "{}: the truth moves by {:.6g} m within {:.6g} s, at {:.6f} s: an outlier, or not in m",
        path.string(), step_m, step_s, 1e-6 * static_cast<double>(truth[i].t_us));
  }
  return std::nullopt;
}

void check_truth(const std::filesystem::path& path, const std::vector<TimedPose>& truth,
                 const TimeSpan& frames, SourceInfo& info) {
  constexpr std::int64_t kLeastStep_us = 100;
  constexpr std::int64_t kMostStep_us = 10000000;
  std::vector<std::int64_t> times;
  for (const TimedPose& pose : truth) times.push_back(pose.t_us);
  const auto warning = check_overlap(path, "the truth", times, frames, kLeastStep_us, kMostStep_us);
  if (warning.has_value()) info.warnings.push_back(*warning);
  const auto fast = check_steps(path, truth);
  if (fast.has_value()) info.warnings.push_back(*fast);
}

}  // namespace cairn::host
