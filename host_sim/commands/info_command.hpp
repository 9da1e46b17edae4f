#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `cairn_sim info`: version, compiler, flags, capacities and sizes of this build.
void register_info_command(CommandContext& context);

}  // namespace cairn::host
