#pragma once

#include <string>
#include <vector>

#include "host_sim/options/exit_code.hpp"
#include "host_sim/options/run_options.hpp"

namespace cairn::host {

/// A kind of SOURCE that `cairn_sim run` knows: `name` or, when `argument` is not empty,
/// `name:argument`. `run` does the whole job and gets what was typed after the colon.
struct RunKind {
  std::string name;
  std::string argument;
  ExitCode (*run)(const RunOptions& options, const std::string& argument);
  std::vector<std::string> options;  ///< that it uses and not every kind does
  bool gives_pictures = true;
  bool has_end = true;  ///< a live camera has none
};

/// Runs `options.source` as its kind does. UsageError for an unknown kind, a wrong argument, and an
/// option that the kind would ignore.
ExitCode dispatch_run(const RunOptions& options);

/// Every kind of source: the list in run_kinds.cpp.
const std::vector<RunKind>& run_kinds();

}  // namespace cairn::host
