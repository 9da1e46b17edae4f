#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `cairn_sim run SOURCE --out DIR ...`: dispatches by the source's name to one of run_kinds().
void register_run_command(CommandContext& context);

}  // namespace cairn::host
