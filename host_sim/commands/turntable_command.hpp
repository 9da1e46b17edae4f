#pragma once

#include "host_sim/commands/command.hpp"
#include "host_sim/commands/sharding.hpp"

namespace cairn::host {

/// `cairn_sim turntable --experiment yaw10|two-axis20|yaw70 --out DIR ...`: paper B's turntable
/// experiments as rendered video or by point simulation, the paper's filter beside ours.
void register_turntable_command(CommandContext& context);

ExitCode conclude_turntable(const PartialResult& whole, const Conclusion& conclusion);

}  // namespace cairn::host
