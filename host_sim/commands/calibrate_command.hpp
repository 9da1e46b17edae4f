#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `cairn_sim calibrate MEDIA --out FILE`: a camera file from pictures of a board.
void register_calibrate_command(CommandContext& context);

}  // namespace cairn::host
