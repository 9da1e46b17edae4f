#include "host_sim/commands/robustness_command.hpp"

#include <filesystem>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/commands/progress.hpp"
#include "host_sim/commands/run_kinds.hpp"
#include "host_sim/commands/source_options.hpp"
#include "host_sim/experiments/robustness/robustness_files.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/options/run_options.hpp"
#include "host_sim/reports/build_info.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

struct RobustnessArguments {
  std::vector<std::string> sources;
  std::vector<int> windows;
  std::vector<std::string> directions = {"forward"};
  std::vector<int> every = {1};
  RobustnessSettings settings;
  RunOptions run;
};

RobustnessSettings settings_of(const RobustnessArguments& arguments) {
  if (!arguments.run.gyro.empty() && arguments.sources.size() > 1) {
    throw UsageError("--gyro: expected one source, whose gyroscope it is");
  }
  if (!arguments.run.gyro.empty() && arguments.settings.filter != kWindowFilter) {
    throw UsageError("--gyro: only for --filter window");
  }
  RobustnessSettings settings = arguments.settings;
  settings.window_frames = arguments.windows[0];
  settings.step_frames = arguments.windows[1];
  settings.playbacks.clear();
  for (const std::string& direction : arguments.directions) {
    for (const int every : arguments.every) {
      settings.playbacks.push_back({direction == "backward", every});
    }
  }
  return settings;
}

/// What the figures depend on beside the recordings.
nlohmann::json settings_json(const RobustnessArguments& arguments,
                             const RobustnessSettings& settings) {
  return {{"sources", arguments.sources},
          {"window_frames", settings.window_frames},
          {"step_frames", settings.step_frames},
          {"seeds", settings.seeds},
          {"filter", settings.filter},
          {"playback", arguments.directions},
          {"every", arguments.every},
          {"gyro", arguments.run.gyro.string()},
          {"max_ate_m", settings.max_ate_m},
          {"max_rotation_deg", settings.max_rotation_deg}};
}

/// Windows are numbered through all sources.
void add_pieces(const RobustnessResult& result, int source, int first, PartialResult& part) {
  for (const WindowResult& window : result.windows) {
    part.pieces[first + window.number] = {
        {"source", source}, {"truth", result.truth}, {"window", whole_window(window)}};
  }
}

ExitCode run(const RobustnessArguments& arguments) {
  const RobustnessSettings settings = settings_of(arguments);
  PartialResult part =
      make_partial("robustness", settings_json(arguments, settings), settings.shard);
  ExitCode worst = ExitCode::kOk;
  int first = 0;
  for (std::size_t i = 0; i < arguments.sources.size(); ++i) {
    RunOptions options = arguments.run;
    options.source = arguments.sources[i];
    options.use_source = [&](FrameSource& opened) {
      const RobustnessResult result = measure_robustness(options.source, opened.info(),
                                                         read_frames(opened), settings, show_runs);
      add_pieces(result, static_cast<int>(i), first, part);
      first += result.windows_of_all_shards;
    };
    const ExitCode result = dispatch_run(options);
    if (result != ExitCode::kOk) worst = result;
  }
  const Conclusion conclusion{arguments.run.out, arguments.run.command_line};
  const ExitCode concluded = conclude_or_leave(part, conclusion, conclude_robustness);
  return worst == ExitCode::kOk ? concluded : worst;
}

void add_options(CLI::App& command, RobustnessArguments& arguments) {
  command.add_option("SOURCE", arguments.sources, "Sources with pictures, as for `run`")
      ->required();
  command.add_option("--out", arguments.run.out, "Folder for the results")->required();
  command
      .add_option("--windows", arguments.windows,
                  "LENGTH,STEP: frames of a window, and from the start of one to the next")
      ->delimiter(',')
      ->expected(2)
      ->check(above_zero())
      ->required();
  command.add_option("--seeds", arguments.settings.seeds, "Seeds 1 to N for every window")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command.add_option("--filter", arguments.settings.filter, "Estimator")
      ->check(CLI::IsMember({"mono", "window"}))
      ->capture_default_str();
  command
      .add_option("--playback", arguments.directions,
                  "forward, backward, or both separated by a comma")
      ->delimiter(',')
      ->check(CLI::IsMember({"forward", "backward"}))
      ->capture_default_str();
  command
      .add_option("--every", arguments.every, "Play each Nth frame; several separated by commas")
      ->delimiter(',')
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command
      .add_option("--max-error", arguments.settings.max_ate_m,
                  "Largest root mean square error of a success, after Sim(3) alignment, m")
      ->check(above_zero())
      ->capture_default_str();
  command
      .add_option("--max-rotation", arguments.settings.max_rotation_deg,
                  "Largest root mean square rotation error of a success, deg")
      ->check(above_zero())
      ->capture_default_str();
  command.add_option("--threads", arguments.settings.threads, "Threads, 0: all")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
  add_shard_option(command, arguments.settings.shard);
  add_range_options(command, arguments.run);
  add_picture_options(command, arguments.run);
  add_gyro_options(command, arguments.run);
}

}  // namespace

ExitCode conclude_robustness(const PartialResult& whole, const Conclusion& conclusion) {
  const nlohmann::json& from = whole.settings;
  RobustnessSettings settings;
  from.at("window_frames").get_to(settings.window_frames);
  from.at("step_frames").get_to(settings.step_frames);
  from.at("seeds").get_to(settings.seeds);
  from.at("filter").get_to(settings.filter);
  from.at("max_ate_m").get_to(settings.max_ate_m);
  from.at("max_rotation_deg").get_to(settings.max_rotation_deg);
  std::vector<RobustnessResult> results(from.at("sources").size());
  for (std::size_t i = 0; i < results.size(); ++i) from.at("sources")[i].get_to(results[i].source);
  for (const auto& [number, piece] : whole.pieces) {
    RobustnessResult& result = results.at(piece.at("source").get<std::size_t>());
    piece.at("truth").get_to(result.truth);
    result.windows.push_back(read_window(piece.at("window")));
  }
  const std::string table = robustness_table(results);
  make_folder(conclusion.out);
  nlohmann::json summary = to_json(results, settings);
  const BuildInfo build = build_info();
  summary["command"] = conclusion.command_line;
  summary["version"] = build.version;
  summary["compiler"] = build.compiler;
  write_windows(conclusion.out / "windows.csv", results);
  write_json(conclusion.out / "robustness.json", summary);
  write_text(conclusion.out / "robustness.md", table);
  fmt::print("{}results in {}\n", table, conclusion.out.string());
  return ExitCode::kOk;
}

void register_robustness_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "robustness", "How often hand-held tracking succeeds on windows of recordings");
  const auto arguments = std::make_shared<RobustnessArguments>();
  add_options(*command, *arguments);
  command->callback([&context, command, arguments] {
    arguments->run.command_line = context.command_line;
    for (const std::string& option : given_options(*command)) {
      const bool own = option == "--every" || option == "--playback" || option == "--filter";
      if (!own) arguments->run.given.push_back(option);
    }
    context.exit_code = run(*arguments);
  });
}

}  // namespace cairn::host
