#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `cairn_sim completion bash|zsh`: a script for the shell that completes commands, options, their
/// values and kinds of sources.
void register_completion_command(CommandContext& context);

}  // namespace cairn::host
