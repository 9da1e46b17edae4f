#include "host_sim/commands/merge_command.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "host_sim/commands/consistency_command.hpp"
#include "host_sim/commands/inject_command.hpp"
#include "host_sim/commands/laps_command.hpp"
#include "host_sim/commands/miscalibration_command.hpp"
#include "host_sim/commands/relocalisation_command.hpp"
#include "host_sim/commands/robustness_command.hpp"
#include "host_sim/commands/timing_command.hpp"
#include "host_sim/commands/turntable_command.hpp"
#include "host_sim/commands/vision_quality_command.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

struct MergeOptions {
  std::vector<std::filesystem::path> folders;
  std::filesystem::path out;
  bool pictures = true;
};

const std::map<std::string, ConcludeExperiment>& experiments() {
  static const std::map<std::string, ConcludeExperiment> list = {
      {"consistency", conclude_consistency},
      {"inject", conclude_inject},
      {"laps", conclude_laps},
      {"miscalibration", conclude_miscalibration},
      {"relocalisation", conclude_relocalisation},
      {"robustness", conclude_robustness},
      {"timing", conclude_timing},
      {"turntable", conclude_turntable},
      {"vision-quality", conclude_vision_quality},
  };
  return list;
}

[[noreturn]] void refuse(const MergeOptions& options, const PartialResult& whole,
                         const char* reason) {
  throw InputError(options.folders.front(),
                   fmt::format("not a shard of {}: {}", whole.experiment, reason));
}

ExitCode run(const MergeOptions& options, const std::string& command_line) {
  const PartialResult whole = join_partials(options.folders);
  const auto experiment = experiments().find(whole.experiment);
  if (experiment == experiments().end()) {
    throw InputError(options.folders.front(),
                     fmt::format("the experiment '{}' is not known", whole.experiment));
  }
  make_folder(options.out);
  try {
    return experiment->second(whole, {options.out, command_line, options.pictures});
  } catch (const nlohmann::json::exception& error) {
    refuse(options, whole, error.what());
  } catch (const std::invalid_argument& error) {
    refuse(options, whole, error.what());
  }
}

}  // namespace

void register_merge_command(CommandContext& context) {
  CLI::App* command =
      context.app.add_subcommand("merge", "Join the shards of an experiment (--shard i/n)");
  const auto options = std::make_shared<MergeOptions>();
  command->add_option("FOLDER", options->folders, "Results of every shard")->required();
  command->add_flag("!--no-pictures", options->pictures, "Do not draw");
  command->add_option("--out", options->out, "Folder for the joined result")->required();
  command->callback(
      [&context, options] { context.exit_code = run(*options, context.command_line); });
}

}  // namespace cairn::host
