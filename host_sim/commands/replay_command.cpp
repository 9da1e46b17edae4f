#include "host_sim/commands/replay_command.hpp"

#include <filesystem>
#include <memory>
#include <string>

#include "host_sim/run/input_log_file.hpp"

namespace cairn::host {
namespace {

struct ReplayArguments {
  std::filesystem::path log;
  ReplayOptions options;
};

}  // namespace

void register_replay_command(CommandContext& context) {
  CLI::App* command =
      context.app.add_subcommand("replay", "Replay an input log, one hash per frame");
  const auto options = std::make_shared<ReplayArguments>();
  command->add_option("LOG", options->log, "Input log that `run --record` wrote")->required();
  command
      ->add_option("--config", options->options.config,
                   "Capacities of the tracker: those of the firmware to compare with")
      ->check(CLI::IsMember({"default", "tiny", "large"}));
  command->add_flag("--marked", options->options.marked,
                    "Draw the virtual objects and mark frames and stages for a profiler");
  command->callback([options] { replay_log(options->log, options->options); });
}

}  // namespace cairn::host
