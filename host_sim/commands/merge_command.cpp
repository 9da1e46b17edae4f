#include "host_sim/commands/merge_command.hpp"

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "host_sim/experiments/consistency/experiment_files.hpp"
#include "host_sim/io/input_error.hpp"

namespace cairn::host {
namespace {

struct MergeOptions {
  std::vector<std::filesystem::path> folders;
  std::filesystem::path out;
};

void check_complete(const ExperimentResult& result) {
  const int count = result.config.shard.count;
  std::string missing;
  for (int shard = 1; shard <= count; ++shard) {
    bool found = false;
    for (const int done : result.shards_done) found = found || done == shard;
    if (!found) missing += fmt::format(" {}/{}", shard, count);
  }
  if (!missing.empty()) {
    throw UsageError(fmt::format("merge: shards are missing:{}", missing));
  }
}

void run(const MergeOptions& options) {
  ExperimentResult result = read_partial(options.folders.front());
  for (std::size_t i = 1; i < options.folders.size(); ++i) {
    const ExperimentResult part = read_partial(options.folders[i]);
    try {
      merge_experiment(result, part);
    } catch (const std::invalid_argument& error) {
      throw InputError(options.folders[i] / "partial.json", error.what());
    }
  }
  check_complete(result);
  write_experiment(result, options.out);
  fmt::print("{}", experiment_table(result));
  if (const auto problem = draw_experiment(options.out)) fmt::print(stderr, "{}\n", *problem);
  fmt::print("results in {}\n", options.out.string());
}

}  // namespace

void register_merge_command(CommandContext& context) {
  CLI::App* command =
      context.app.add_subcommand("merge", "Join the shards of a consistency experiment");
  const auto options = std::make_shared<MergeOptions>();
  command->add_option("FOLDER", options->folders, "Results of every shard")->required();
  command->add_option("--out", options->out, "Folder for the joined result")->required();
  command->callback([options] { run(*options); });
}

}  // namespace cairn::host
