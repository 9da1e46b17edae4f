#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `check-mount`: whether a drive contradicts the camera file and the mount.
void register_check_mount_command(CommandContext& context);

}  // namespace cairn::host
