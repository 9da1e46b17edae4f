#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// cairn_sim replay LOG: the frames of an input log again, one hash each, as the firmware prints
/// it.
void register_replay_command(CommandContext& context);

}  // namespace cairn::host
