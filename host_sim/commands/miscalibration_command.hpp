#pragma once

#include "host_sim/commands/command.hpp"
#include "host_sim/commands/sharding.hpp"

namespace cairn::host {

/// `miscalibration`: wrong calibrations of a drive, and what a tracker says of them.
void register_miscalibration_command(CommandContext& context);
ExitCode conclude_miscalibration(const PartialResult& whole, const Conclusion& conclusion);

}  // namespace cairn::host
