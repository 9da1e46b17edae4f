#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `cairn_sim robustness`: how often hand-held tracking succeeds on windows of recordings.
void register_robustness_command(CommandContext& context);

}  // namespace cairn::host
