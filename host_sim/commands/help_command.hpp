#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `cairn_sim help [COMMAND]`: what `cairn_sim [COMMAND] --help` prints.
void register_help_command(CommandContext& context);

}  // namespace cairn::host
