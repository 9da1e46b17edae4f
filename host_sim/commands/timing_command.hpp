#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

void register_timing_command(CommandContext& context);

}  // namespace cairn::host
