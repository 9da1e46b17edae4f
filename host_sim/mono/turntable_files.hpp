#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/mono/turntable_experiment.hpp"

namespace cairn::host {

/// Writes runs.csv (a row per run), frames.csv (first seed of every cell, a row per frame) and
/// summary.json (medians and worst values per condition and variant).
void write_turntable(const TurntableConfig& config, const std::vector<TurntableCell>& cells,
                     const std::filesystem::path& out);

/// The table that the command prints, and summary.md.
std::string turntable_table(const std::vector<TurntableCell>& cells);

/// Draws yaw_error.png and fading.png from the files in `out` with python3 and matplotlib; says so
/// on stderr and returns false where there is none.
bool draw_turntable(const std::filesystem::path& out);

}  // namespace cairn::host
