#include "host_sim/commands/consistency_command.hpp"

#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "cairn/numeric/math.hpp"

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/commands/progress.hpp"
#include "host_sim/experiments/consistency/experiment_files.hpp"
#include "host_sim/experiments/consistency/filter.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

struct ConsistencyOptions {
  int runs = 50;
  double heading_variance = 0.0;
  double position_variance = 1.0;
  std::string odometry_noise = "s1";
  std::optional<double> steering_noise_deg;
  NoisePoint noise_point = NoisePoint::kReading;
  double steady_s = 0.3;
  std::vector<std::string> filters;  ///< empty: the default
  std::vector<std::string> scalars;  ///< empty: double
  std::uint64_t seed = 1;
  int threads = 0;
  Shard shard;
  bool pictures = true;
  std::filesystem::path out;
};

/// Every filter with every scalar: a filter in double has the plain name.
std::vector<std::string> filters_of(const ConsistencyOptions& options) {
  std::vector<std::string> filters = options.filters;
  if (filters.empty()) {
    if (options.scalars.empty()) return {"ekf", "reduced-jacobian", "group-iekf"};
    filters = {"group-iekf"};
  }
  if (options.scalars.empty()) return filters;
  std::vector<std::string> named;
  for (const auto& filter : filters) {
    for (const auto& scalar : options.scalars) {
      named.push_back(scalar == "double" ? filter : fmt::format("{}-{}", filter, scalar));
    }
  }
  return named;
}

ExperimentConfig make_config(const ConsistencyOptions& options) {
  ExperimentConfig config;
  config.runs = options.runs;
  config.seed = options.seed;
  config.filters = filters_of(options);
  config.threads = options.threads;
  config.shard = options.shard;
  SimulationConfig& simulation = config.simulation;
  simulation.heading_variance_rad2 = options.heading_variance;
  simulation.position_variance_m2 = options.position_variance;
  constexpr double kDegree = kPi<double> / 180.0;
  const bool base = options.odometry_noise == "base";
  simulation.speed_sigma_mps = base ? 0.05 : 0.1;
  simulation.steering_sigma_rad = options.steering_noise_deg.value_or(base ? 2.0 : 5.0) * kDegree;
  simulation.noise_point = options.noise_point;
  simulation.steady_s = options.steady_s;
  return config;
}

void check_filters(const std::vector<std::string>& filters) {
  try {
    for (const auto& filter : filters) (void)make_filter_under_test(filter, 1);
  } catch (const std::invalid_argument& error) {
    throw UsageError(fmt::format("--filters: {}", error.what()));
  }
}

void run(const ConsistencyOptions& options, const std::string& command_line) {
  const ExperimentConfig config = make_config(options);
  check_filters(config.filters);
  make_folder(options.out);
  const ExperimentResult result = run_experiment(config, show_runs);
  PartialResult part = make_partial("consistency", configuration_json(result.config), config.shard);
  part.pieces[config.shard.index] = sums_of(result);
  conclude_or_leave(part, {options.out, command_line, options.pictures}, conclude_consistency);
}

void add_options(CLI::App& command, ConsistencyOptions& options) {
  command.add_option("--runs", options.runs, "Monte-Carlo runs, over all shards")
      ->check(CLI::Range(1, 100000))
      ->required();
  command
      .add_option("--heading-variance", options.heading_variance,
                  "Variance of the start heading, rad^2")
      ->check(between(0.0, 10.0))
      ->required();
  command
      .add_option("--position-variance", options.position_variance,
                  "Variance of each start coordinate, m^2")
      ->check(between(0.0, 100.0))
      ->capture_default_str();
  command
      .add_option("--odometry-noise", options.odometry_noise,
                  "s1: 0.1 m/s and 5 deg; base: 0.05 m/s and 2 deg")
      ->check(CLI::IsMember({"s1", "base"}))
      ->capture_default_str();
  command
      .add_option("--steering-noise", options.steering_noise_deg,
                  "Standard deviation of the steering angle, deg, in place of the set's")
      ->check(between(0.0, 45.0));
  const std::map<std::string, NoisePoint> points = {{"reading", NoisePoint::kReading},
                                                    {"steady", NoisePoint::kSteady},
                                                    {"truth", NoisePoint::kTruth}};
  command
      .add_option("--noise-at", options.noise_point,
                  "Where odometry noise is linearised: reading (default), steady, truth")
      ->transform(CLI::CheckedTransformer(points));
  command
      .add_option("--steady-s", options.steady_s,
                  "Low pass of the readings for --noise-at steady, s")
      ->check(between(0.0, 60.0))
      ->capture_default_str();
  command
      .add_option("--filters", options.filters,
                  "Filters, separated by commas; default ekf,reduced-jacobian,group-iekf, with "
                  "--scalar group-iekf")
      ->delimiter(',');
  command
      .add_option("--scalar", options.scalars,
                  "Numbers that the core's filters work with, separated by commas: double "
                  "(default), float, fixed (group-iekf and ekf)")
      ->delimiter(',')
      ->check(CLI::IsMember({"double", "float", "fixed"}));
  command.add_option("--seed", options.seed, "Seed of every run")
      ->check(seed_number())
      ->capture_default_str();
  command.add_option("--threads", options.threads, "Threads, 0: all; never changes the result")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  add_shard_option(command, options.shard);
  command.add_flag("!--no-pictures", options.pictures, "Do not draw");
  command.add_option("--out", options.out, "Folder for the results")->required();
}

}  // namespace

ExitCode conclude_consistency(const PartialResult& whole, const Conclusion& conclusion) {
  std::optional<ExperimentResult> result;
  for (const auto& [shard, sums] : whole.pieces) {
    ExperimentResult part = read_sums(whole.settings, sums);
    if (result.has_value()) {
      merge_experiment(*result, part);
    } else {
      result = std::move(part);
    }
  }
  make_folder(conclusion.out);
  write_manifest(conclusion.out, {conclusion.command_line, result->config.seed,
                                  "see summary.json, experiment", nullptr});
  write_experiment(*result, conclusion.out);
  fmt::print("{}", experiment_table(*result));
  if (conclusion.pictures) {
    if (const auto problem = draw_experiment(conclusion.out)) fmt::print(stderr, "{}\n", *problem);
  }
  fmt::print("results in {}\n", conclusion.out.string());
  return ExitCode::kOk;
}

void register_consistency_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "consistency", "Average NEES of planar SLAM filters over many simulated runs");
  const auto options = std::make_shared<ConsistencyOptions>();
  add_options(*command, *options);
  command->callback([&context, options] { run(*options, context.command_line); });
}

}  // namespace cairn::host
