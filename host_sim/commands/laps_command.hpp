#pragma once

#include "host_sim/commands/command.hpp"
#include "host_sim/commands/sharding.hpp"

namespace cairn::host {

/// `cairn_sim laps`: a day in one hall.
void register_laps_command(CommandContext& context);

ExitCode conclude_laps(const PartialResult& whole, const Conclusion& conclusion);

}  // namespace cairn::host
