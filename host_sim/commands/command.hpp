#pragma once

#include <string>

#include <CLI/CLI.hpp>

#include "host_sim/options/exit_code.hpp"

namespace cairn::host {

/// Where a command adds itself. A register function adds one subcommand to `app`; its callback does
/// the work and stores the outcome in `exit_code`. It may throw InputError (exit code 3) and
/// UsageError (2). Options live in a std::shared_ptr captured by the callback.
struct CommandContext {
  CLI::App& app;
  std::string command_line;  ///< as typed, for the manifest
  ExitCode exit_code = ExitCode::kOk;
};

/// Adds every command: the list in command_list.cpp.
void register_commands(CommandContext& context);

}  // namespace cairn::host
