#include "host_sim/commands/replay_command.hpp"

#include <filesystem>
#include <memory>
#include <string>

#include "host_sim/trackers/input_log_file.hpp"

namespace cairn::host {
namespace {

struct ReplayArguments {
  std::filesystem::path log;
  std::string config;
};

}  // namespace

void register_replay_command(CommandContext& context) {
  CLI::App* command =
      context.app.add_subcommand("replay", "Replay an input log, one hash per frame");
  const auto arguments = std::make_shared<ReplayArguments>();
  command->add_option("LOG", arguments->log, "Input log that `run --record` wrote")->required();
  command
      ->add_option("--config", arguments->config,
                   "Capacities of the tracker: those of the firmware to compare with")
      ->check(CLI::IsMember({"default", "tiny", "large"}));
  command->callback([arguments] { replay_log(arguments->log, arguments->config); });
}

}  // namespace cairn::host
