#pragma once

#include "host_sim/commands/command.hpp"
#include "host_sim/commands/sharding.hpp"

namespace cairn::host {

/// `cairn_sim relocalisation`: trials in the hall, or on a recording of a hand-held camera.
void register_relocalisation_command(CommandContext& context);

ExitCode conclude_relocalisation(const PartialResult& whole, const Conclusion& conclusion);

}  // namespace cairn::host
