#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `cairn_sim laps`: a day in one hall.
void register_laps_command(CommandContext& context);

}  // namespace cairn::host
