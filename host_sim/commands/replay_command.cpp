#include "host_sim/commands/replay_command.hpp"

#include <filesystem>
#include <memory>
#include <string>

#include "host_sim/run/input_log_file.hpp"

namespace cairn::host {
namespace {

struct ReplayOptions {
  std::filesystem::path log;
  std::string config;
};

}  // namespace

void register_replay_command(CommandContext& context) {
  CLI::App* command =
      context.app.add_subcommand("replay", "Replay an input log, one hash per frame");
  const auto options = std::make_shared<ReplayOptions>();
  command->add_option("LOG", options->log, "Input log that `run --record` wrote")->required();
  command
      ->add_option("--config", options->config,
                   "Capacities of the tracker: those of the firmware to compare with")
      ->check(CLI::IsMember({"default", "tiny", "large"}));
  command->callback([options] { replay_log(options->log, options->config); });
}

}  // namespace cairn::host
