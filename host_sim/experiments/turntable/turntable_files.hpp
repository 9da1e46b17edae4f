#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/experiments/turntable/turntable_experiment.hpp"

namespace cairn::host {

/// Writes runs.csv (a row per run), frames.csv (first seed of every cell, a row per frame) and
/// summary.json (medians and worst values per condition and variant).
void write_turntable(const TurntableConfig& config, const std::vector<TurntableCell>& cells,
                     const std::filesystem::path& out);

/// The table that the command prints, and summary.md.
std::string turntable_table(const std::vector<TurntableCell>& cells);

/// Draws fading.png, angles.png, yaw_error.png and pitch_error.png from the files in `out` with
/// python3 and matplotlib. Nothing on success, else a sentence that says why there are none.
std::optional<std::string> draw_turntable(const std::filesystem::path& out);

}  // namespace cairn::host
