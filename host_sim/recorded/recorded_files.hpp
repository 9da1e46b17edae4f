#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "host_sim/recorded/recorded_run.hpp"

namespace cairn::host {

/// Writes what a recorded run leaves in `out` (created if missing): manifest.json, trajectory.tum,
/// truth.tum, landmarks.csv, samples.csv, frames.csv, summary.json, and report.html where
/// there is python3. The summary goes by the alignment `start` where the truth has headings, else
/// `se2`.
void write_recorded_run(const Recording& recording, const RecordedRunOptions& options,
                        const RecordedRun& run, const std::string& command_line,
                        const std::filesystem::path& out);

nlohmann::json recorded_summary(const Recording& recording, const RecordedRunOptions& options,
                                const RecordedRun& run);

}  // namespace cairn::host
