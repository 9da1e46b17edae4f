#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "host_sim/experiments/consistency/experiment.hpp"

namespace cairn::host {

/// Writes what an experiment leaves in `out` (created if missing): consistency.csv, summary.json
/// and sample.csv (paths of run 0, for the picture). consistency.csv and sample.csv are equal to
/// the byte for any number of threads or shards.
void write_experiment(const ExperimentResult& result, const std::filesystem::path& out);

/// What the shards of one experiment have in common.
nlohmann::json configuration_json(const ExperimentConfig& config);

/// The sums of a shard, and back with the experiment's configuration. Reading throws where a key is
/// missing or of another type.
nlohmann::json sums_of(const ExperimentResult& result);
ExperimentResult read_sums(const nlohmann::json& configuration, const nlohmann::json& sums);

/// Per filter and loop: mean NEES, percent of steps in the band, errors, times.
nlohmann::json experiment_summary(const ExperimentResult& result);

/// The table on the terminal.
std::string experiment_table(const ExperimentResult& result);

/// Draws nees.png, error.png and field.png from the files in `out` with python3 and matplotlib.
/// Nothing on success, else a sentence that says why there are none: the figures are in the CSV.
std::optional<std::string> draw_experiment(const std::filesystem::path& out);

}  // namespace cairn::host
