#pragma once

#include "host_sim/commands/command.hpp"

namespace cairn::host {

/// `cairn_sim merge`: joins the shards of an experiment that ran with --shard i/n.
void register_merge_command(CommandContext& context);

}  // namespace cairn::host
