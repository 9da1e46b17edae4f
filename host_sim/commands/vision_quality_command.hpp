#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// cairn_sim vision-quality SETS --out DIR: how often descriptors find their own point again.
void register_vision_quality_command(CommandContext& context);

}  // namespace cairn::host
