#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "host_sim/experiments/consistency/experiment.hpp"

namespace cairn::host {

/// Writes what an experiment leaves in `out` (created if missing): consistency.csv, summary.json,
/// partial.json (the sums, for `cairn_sim merge`) and sample.csv (paths of run 0, for the picture).
/// consistency.csv and sample.csv are equal to the byte for any number of threads or shards.
void write_experiment(const ExperimentResult& result, const std::filesystem::path& out);

/// Reads `folder`/partial.json. Throws InputError naming the file and the key.
ExperimentResult read_partial(const std::filesystem::path& folder);

/// Per filter and loop: mean NEES, percent of steps in the band, errors, times.
nlohmann::json experiment_summary(const ExperimentResult& result);

/// The table on the terminal.
std::string experiment_table(const ExperimentResult& result);

/// Draws nees.png, error.png and field.png from the files in `out` with python3 and matplotlib.
/// Nothing on success, else a sentence that says why there are none: the figures are in the CSV.
std::optional<std::string> draw_experiment(const std::filesystem::path& out);

}  // namespace cairn::host
