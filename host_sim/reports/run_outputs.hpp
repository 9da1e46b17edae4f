#pragma once

#include <filesystem>
#include <string>

#include "host_sim/running/runner.hpp"

namespace cairn::host {

/// What a run was asked to do, for its manifest.
struct RunIdentity {
  std::string command_line;
  TrackerOptions options;
  std::string source;
};

/// The files of a run. docs/reference/outputs.md describes each field.
void write_manifest(const std::filesystem::path& folder, const RunIdentity& identity,
                    const SourceInfo& source, const RunRecord& record);
void write_frames(const std::filesystem::path& folder, const RunRecord& record,
                  const RegistrationResult& registration);
/// uncertainty.csv: what each frame states of its pose, and how healthy it was.
void write_uncertainty(const std::filesystem::path& folder, const RunRecord& record);
/// health.csv: in which frame which counter grew.
void write_health(const std::filesystem::path& folder, const RunRecord& record);
void write_landmarks(const std::filesystem::path& folder, const RunRecord& record);

}  // namespace cairn::host
