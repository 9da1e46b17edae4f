#pragma once

#include "host_sim/commands/command.hpp"
#include "host_sim/commands/sharding.hpp"

namespace cairn::host {

void register_timing_command(CommandContext& context);

ExitCode conclude_timing(const PartialResult& whole, const Conclusion& conclusion);

}  // namespace cairn::host
