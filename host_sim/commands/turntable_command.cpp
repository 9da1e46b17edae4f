#include "host_sim/commands/turntable_command.hpp"

#include <charconv>
#include <filesystem>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/commands/progress.hpp"
#include "host_sim/experiments/turntable/rendered_turntable.hpp"
#include "host_sim/experiments/turntable/turntable_files.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PointsFrame, t_s, true_yaw_deg, yaw_error_deg, pitch_error_deg,
                                   attitude_error_deg, attitude_nees, nis, nis_dof, features,
                                   inliers, fading_factor)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(PointsResult, frames, max_yaw_error_deg, mean_yaw_error_deg,
                                   mse_yaw_error_deg2, final_yaw_error_deg, mean_pitch_error_deg,
                                   mean_attitude_error_deg, max_attitude_error_deg, mean_nees,
                                   mean_nis, focal_factor, mean_hypotheses, mean_features,
                                   mean_filter_us, final_distance_m, displacement_ratio,
                                   no_consensus, lost)

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
  Shard shard;
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
  config.shard = options.shard;
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

nlohmann::json settings_json(const TurntableOptions& options, const TurntableConfig& config,
                             const std::vector<TurntableCell>& cells) {
  nlohmann::json names = nlohmann::json::array();
  for (const TurntableCell& cell : cells) names.push_back({cell.condition, cell.variant});
  return {{"experiment", static_cast<int>(config.experiment)},
          {"seed", config.seed},
          {"seeds", config.seeds},
          {"points", options.points},
          {"measurement", static_cast<int>(options.measurement)},
          {"cells", std::move(names)}};
}

/// A piece a run; frames are kept of the first seed alone, as they are written.
void add_pieces(const std::vector<TurntableCell>& cells, const Shard& shard, PartialResult& part) {
  std::size_t number = 0;
  for (const TurntableCell& cell : cells) {
    for (std::size_t run = 0; run < cell.runs.size(); ++run, ++number) {
      if (!shard.has(number)) continue;
      PointsResult result = cell.runs[run];
      if (run > 0) result.frames.clear();
      part.pieces[static_cast<int>(number)] = result;
    }
  }
}

ExitCode run(const TurntableOptions& options, const std::string& command_line) {
  const TurntableConfig config = make_config(options);
  make_folder(options.out);
  const std::vector<TurntableCell> cells =
      options.points ? run_turntable(config, show_runs)
                     : run_rendered_turntable(config, options.measurement, show_runs);
  PartialResult part =
      make_partial("turntable", settings_json(options, config, cells), options.shard);
  add_pieces(cells, options.shard, part);
  return conclude_or_leave(part, {options.out, command_line, options.pictures}, conclude_turntable);
}

}  // namespace

ExitCode conclude_turntable(const PartialResult& whole, const Conclusion& conclusion) {
  TurntableConfig config;
  config.experiment = static_cast<TurntableExperiment>(whole.settings.at("experiment").get<int>());
  whole.settings.at("seed").get_to(config.seed);
  whole.settings.at("seeds").get_to(config.seeds);
  std::vector<TurntableCell> cells;
  for (const nlohmann::json& names : whole.settings.at("cells")) {
    cells.push_back({names.at(0).get<std::string>(), names.at(1).get<std::string>(), {}});
  }
  for (const auto& [number, piece] : whole.pieces) {
    cells.at(static_cast<std::size_t>(number / config.seeds))
        .runs.push_back(piece.get<PointsResult>());
  }
  make_folder(conclusion.out);
  write_manifest(conclusion.out,
                 {conclusion.command_line, config.seed, "see summary.json", nullptr});
  write_turntable(config, cells, conclusion.out);
  fmt::print("{}", turntable_table(cells));
  if (conclusion.pictures) {
    if (const auto problem = draw_turntable(conclusion.out)) fmt::print(stderr, "{}\n", *problem);
  }
  fmt::print("results in {}\n", conclusion.out.string());
  return ExitCode::kOk;
}

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
  add_shard_option(*command, options->shard);
  command->add_flag("!--no-pictures", options->pictures, "Leave the pictures out");
  command->add_option("--out", options->out, "Folder of the results")->required();
  command->callback(
      [options, &context] { context.exit_code = run(*options, context.command_line); });
}

}  // namespace cairn::host
