#pragma once

#include "host_sim/commands/command.hpp"
#include "host_sim/commands/sharding.hpp"

namespace cairn::host {

/// `cairn_sim robustness`: how often hand-held tracking succeeds on windows of recordings.
void register_robustness_command(CommandContext& context);

ExitCode conclude_robustness(const PartialResult& whole, const Conclusion& conclusion);

}  // namespace cairn::host
