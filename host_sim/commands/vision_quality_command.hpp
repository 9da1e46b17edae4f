#pragma once

#include "host_sim/commands/command.hpp"
#include "host_sim/commands/sharding.hpp"

namespace cairn::host {

/// cairn_sim vision-quality SETS --out DIR: how often descriptors find their own point again.
void register_vision_quality_command(CommandContext& context);

ExitCode conclude_vision_quality(const PartialResult& whole, const Conclusion& conclusion);

}  // namespace cairn::host
