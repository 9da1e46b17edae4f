#pragma once

#include "host_sim/commands/command.hpp"
#include "host_sim/commands/sharding.hpp"

namespace cairn::host {

/// `cairn_sim consistency`: paper A's experiment 4.1, the average NEES over many runs.
void register_consistency_command(CommandContext& context);

ExitCode conclude_consistency(const PartialResult& whole, const Conclusion& conclusion);

}  // namespace cairn::host
