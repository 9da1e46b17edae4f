#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace cairn::host {

/// Makes report.html of a finished run from the files in `folder` (matplotlib through python3).
/// Nothing on success, else a message that says what is missing: the run itself is complete
/// without.
std::optional<std::string> write_report(const std::filesystem::path& folder);

/// Same for timing.png of a folder with a frame_times.csv.
std::optional<std::string> draw_timing(const std::filesystem::path& folder);

}  // namespace cairn::host
