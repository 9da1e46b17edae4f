#include "host_sim/commands/check_mount_command.hpp"

#include <memory>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/commands/run_kinds.hpp"
#include "host_sim/commands/source_options.hpp"
#include "host_sim/options/run_options.hpp"

namespace cairn::host {

void register_check_mount_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "check-mount", "Whether a drive contradicts the camera file and the camera's mount");
  const auto options = std::make_shared<RunOptions>();
  options->check_mount = true;
  command->add_option("SOURCE", options->source, "As for `run`, in vehicle mode")->required();
  add_range_options(*command, *options);
  add_picture_options(*command, *options);
  add_odometry_options(*command, *options);
  command
      ->add_option("--suspension", options->suspension,
                   "How the vehicle's body pitches and rolls; by default as the source says")
      ->check(CLI::IsMember({"flat", "car", "rover"}));
  command->add_option("--seed", options->seed, "Seed of everything random")
      ->check(seed_number())
      ->capture_default_str();
  command->callback([&context, command, options] {
    options->mode = "vehicle";
    options->command_line = context.command_line;
    options->given = given_options(*command);
    context.exit_code = dispatch_run(*options);
  });
}

}  // namespace cairn::host
