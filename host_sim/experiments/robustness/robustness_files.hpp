#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host_sim/experiments/robustness/robustness.hpp"

namespace cairn::host {

/// A line for every source and way to play it: success, silent failures, tracked share, errors.
std::string robustness_table(const std::vector<RobustnessResult>& results);

/// The same figures, and every window. A figure without truth is null, as is an error's median or
/// worst value where most or some windows have too few tracked frames to have one.
nlohmann::json to_json(const std::vector<RobustnessResult>& results,
                       const RobustnessSettings& settings);

/// A window with every field, and back; reading throws where one is missing.
nlohmann::json whole_window(const WindowResult& window);
WindowResult read_window(const nlohmann::json& window);

/// One line for each window. Throws OutputError where `file` cannot be written.
void write_windows(const std::filesystem::path& file, const std::vector<RobustnessResult>& results);

}  // namespace cairn::host
