#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "host_sim/evaluation/trajectory_evaluation.hpp"
#include "host_sim/running/runner.hpp"

namespace cairn::host {

/// Trajectory of a run, estimate against truth where that is known.
struct RunTrajectory {
  Alignment alignment = Alignment::kStart;
  bool planar = false;
  std::optional<TrajectoryEvaluation> evaluation;
  std::vector<std::size_t> compared;  ///< frames that have both estimate and truth
};

RunTrajectory evaluate_run(const RunRecord& record, Mode mode);

/// trajectory.tum, truth.tum and the same in KITTI's format.
void write_trajectories(const std::filesystem::path& folder, const RunRecord& record, Mode mode);

}  // namespace cairn::host
