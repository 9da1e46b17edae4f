#include "host_sim/commands/turntable_command.hpp"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <unistd.h>

#include <fmt/format.h>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/experiments/turntable/rendered_turntable.hpp"
#include "host_sim/experiments/turntable/turntable_files.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

struct TurntableOptions {
  std::string experiment;
  std::vector<std::string> fading = {"1.000", "1.003", "1.006",   "1.009",
                                     "1.015", "1.030", "adaptive"};
  std::string condition;
  std::uint64_t seed = 1;
  int seeds = 0;  ///< 0: one of the video, 20 of the points
  bool points = false;
  Measurement measurement = Measurement::kPatch;
  bool pictures = true;
  std::filesystem::path out;
};

TurntableConfig make_config(const TurntableOptions& options) {
  TurntableConfig config;
  if (!parse_experiment(options.experiment, config.experiment)) {
    throw UsageError(
        fmt::format("--experiment '{}': expected yaw10, two-axis20, yaw70, static or swing",
                    options.experiment));
  }
  config.condition = options.condition;
  if (turntable_conditions(config).empty()) {
    throw UsageError(
        fmt::format("--condition '{}': no condition has this in its name", options.condition));
  }
  config.seed = options.seed;
  config.seeds = options.seeds > 0 ? options.seeds : (options.points ? 20 : 1);
  config.adaptive = false;
  config.fading.clear();
  for (const std::string& item : options.fading) {
    if (item == "adaptive") {
      config.adaptive = true;
      continue;
    }
    double factor = 0.0;
    const auto end = item.data() + item.size();
    const auto parsed = std::from_chars(item.data(), end, factor);
    if (parsed.ec != std::errc() || parsed.ptr != end || !(factor >= 1.0) || factor > 2.0) {
      throw UsageError(
          fmt::format("--fading '{}': expected a factor from 1 to 2, or adaptive", item));
    }
    config.fading.push_back(factor);
  }
  return config;
}

void run(const TurntableOptions& options, const std::string& command_line) {
  const TurntableConfig config = make_config(options);
  make_folder(options.out);
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const auto progress = [terminal](int done, int total) {
    if (!terminal) return;
    fmt::print(stderr, "\rrun {} of {} ({:.0f} %)", done, total, 100.0 * done / total);
    std::fflush(stderr);
  };
  const std::vector<TurntableCell> cells =
      options.points ? run_turntable(config, progress)
                     : run_rendered_turntable(config, options.measurement, progress);
  if (terminal) fmt::print(stderr, "\r{:40}\r", "");
  write_manifest(options.out, {command_line, options.seed, "see summary.json", nullptr});
  write_turntable(config, cells, options.out);
  fmt::print("{}", turntable_table(cells));
  if (options.pictures) {
    if (const auto problem = draw_turntable(options.out)) fmt::print(stderr, "{}\n", *problem);
  }
  fmt::print("results in {}\n", options.out.string());
}

}  // namespace

void register_turntable_command(CommandContext& context) {
  auto options = std::make_shared<TurntableOptions>();
  CLI::App* command = context.app.add_subcommand(
      "turntable", "Paper B's turntable experiments, its filter beside ours");
  command
      ->add_option("--experiment", options->experiment, "yaw10, two-axis20, yaw70, static, swing")
      ->required();
  command
      ->add_option("--fading", options->fading,
                   "Fading factors and 'adaptive', separated by commas")
      ->delimiter(',');
  command->add_option("--condition", options->condition,
                      "Only conditions with this in their name, such as 'outliers'");
  command->add_option("--seed", options->seed, "First seed")->check(seed_number());
  command->add_option("--seeds", options->seeds, "Number of seeds (default 1, with --points 20)")
      ->check(CLI::Range(1, 10000));
  command->add_flag("--points", options->points, "Simulate points alone instead of rendered video");
  const std::map<std::string, Measurement> measurements = {{"patch", Measurement::kPatch},
                                                           {"freak", Measurement::kFreak}};
  command
      ->add_option("--measurement", options->measurement,
                   "How features are found in the video: patch or freak")
      ->transform(CLI::CheckedTransformer(measurements, CLI::ignore_case));
  command->add_flag("!--no-pictures", options->pictures, "Leave the pictures out");
  command->add_option("--out", options->out, "Folder of the results")->required();
  command->callback([options, &context] {
    run(*options, context.command_line);
    context.exit_code = ExitCode::kOk;
  });
}

}  // namespace cairn::host
