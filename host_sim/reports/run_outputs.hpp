#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host_sim/evaluation/trajectory_evaluation.hpp"
#include "host_sim/running/runner.hpp"

namespace cairn::host {

/// What a run was asked to do, for its manifest.
struct RunIdentity {
  std::string command_line;
  TrackerOptions options;
  std::string source;
};

/// Trajectory of a run, estimate against truth where that is known.
struct RunTrajectory {
  Alignment alignment = Alignment::kStart;
  bool planar = false;
  std::optional<TrajectoryEvaluation> evaluation;
  std::vector<std::size_t> compared;  ///< frames that have both estimate and truth
};

RunTrajectory evaluate_run(const RunRecord& record, Mode mode);

/// The files of a run. docs/reference/outputs.md describes each field.
void write_manifest(const std::filesystem::path& folder, const RunIdentity& identity,
                    const SourceInfo& source, const RunRecord& record);
void write_frames(const std::filesystem::path& folder, const RunRecord& record,
                  const RegistrationResult& registration);
void write_trajectories(const std::filesystem::path& folder, const RunRecord& record, Mode mode);
/// uncertainty.csv: what each frame states of its pose, and how healthy it was.
void write_uncertainty(const std::filesystem::path& folder, const RunRecord& record);
/// health.csv: in which frame which counter grew.
void write_health(const std::filesystem::path& folder, const RunRecord& record);
void write_landmarks(const std::filesystem::path& folder, const RunRecord& record);
nlohmann::json summarise(const RunRecord& record, const RunTrajectory& trajectory,
                         const RegistrationResult& registration, double budget_ms,
                         const SourceInfo& source);

/// Every counter by its name.
nlohmann::json to_json(const Health& health);

}  // namespace cairn::host
