#include "host_sim/commands/calibrate_command.hpp"
#include "host_sim/commands/check_mount_command.hpp"
#include "host_sim/commands/command.hpp"
#include "host_sim/commands/completion_command.hpp"
#include "host_sim/commands/consistency_command.hpp"
#include "host_sim/commands/help_command.hpp"
#include "host_sim/commands/info_command.hpp"
#include "host_sim/commands/inject_command.hpp"
#include "host_sim/commands/laps_command.hpp"
#include "host_sim/commands/merge_command.hpp"
#include "host_sim/commands/miscalibration_command.hpp"
#include "host_sim/commands/relocalisation_command.hpp"
#include "host_sim/commands/replay_command.hpp"
#include "host_sim/commands/robustness_command.hpp"
#include "host_sim/commands/run_command.hpp"
#include "host_sim/commands/simulate_gyro_command.hpp"
#include "host_sim/commands/timing_command.hpp"
#include "host_sim/commands/turntable_command.hpp"
#include "host_sim/commands/vision_command.hpp"
#include "host_sim/commands/vision_quality_command.hpp"

namespace cairn::host {

void register_commands(CommandContext& context) {
  register_run_command(context);
  register_calibrate_command(context);
  register_check_mount_command(context);
  register_replay_command(context);
  register_info_command(context);
  register_inject_command(context);
  register_consistency_command(context);
  register_relocalisation_command(context);
  register_laps_command(context);
  register_merge_command(context);
  register_miscalibration_command(context);
  register_robustness_command(context);
  register_simulate_gyro_command(context);
  register_timing_command(context);
  register_turntable_command(context);
  register_vision_command(context);
  register_vision_quality_command(context);
  register_completion_command(context);
  register_help_command(context);
}

}  // namespace cairn::host
