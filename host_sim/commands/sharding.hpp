#pragma once

#include <filesystem>
#include <string>

#include <CLI/CLI.hpp>

#include "host_sim/options/exit_code.hpp"
#include "host_sim/reports/partial_result.hpp"

namespace cairn::host {

/// How every experiment is done in parts: it writes its pieces into a PartialResult, and a function
/// of it makes tables and files out of the whole, whether from one run or by `merge`.

/// Where the results of a whole experiment go.
struct Conclusion {
  std::filesystem::path out;
  std::string command_line;
  bool pictures = true;
};
using ConcludeExperiment = ExitCode (*)(const PartialResult& whole, const Conclusion& conclusion);

/// Adds --shard i/n.
void add_shard_option(CLI::App& command, Shard& shard);

/// Concludes a whole experiment by `conclude`; leaves a shard for `merge` in the folder.
ExitCode conclude_or_leave(const PartialResult& part, const Conclusion& conclusion,
                           ConcludeExperiment conclude);

}  // namespace cairn::host
