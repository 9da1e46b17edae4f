#pragma once

#include "host_sim/commands/command.hpp"
#include "host_sim/commands/sharding.hpp"

namespace cairn::host {

/// `cairn_sim inject`: faults put into the inputs of a tracker, and what becomes of them.
void register_inject_command(CommandContext& context);

ExitCode conclude_inject(const PartialResult& whole, const Conclusion& conclusion);

}  // namespace cairn::host
