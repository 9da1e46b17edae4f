#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `cairn_sim faults`: kidnapped trials in the built-in hall.
void register_faults_command(CommandContext& context);

}  // namespace cairn::host
