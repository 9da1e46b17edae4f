#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `cairn_sim simulate-gyro`: a gyroscope's samples from a camera's true poses.
void register_simulate_gyro_command(CommandContext& context);

}  // namespace cairn::host
