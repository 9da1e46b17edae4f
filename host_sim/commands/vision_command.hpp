#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// cairn_sim vision IMAGE --out DIR: corners and descriptors of one image.
void register_vision_command(CommandContext& context);

}  // namespace cairn::host
