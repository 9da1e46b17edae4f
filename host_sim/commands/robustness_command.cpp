#include "host_sim/commands/robustness_command.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <unistd.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/commands/run_kinds.hpp"
#include "host_sim/commands/source_options.hpp"
#include "host_sim/experiments/robustness/robustness_files.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/options/run_options.hpp"
#include "host_sim/reports/build_info.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
namespace {

struct Arguments {
  std::vector<std::string> sources;
  std::vector<int> windows;
  std::vector<std::string> directions = {"forward"};
  std::vector<int> every = {1};
  RobustnessSettings settings;
  RunOptions run;
};

RobustnessSettings settings_of(const Arguments& arguments) {
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

void show_progress(int done, int total) {
  if (isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\rrun {} of {}", done, total);
  if (done == total) fmt::print(stderr, "\r{:40}\r", "");
  std::fflush(stderr);
}

void write(const std::filesystem::path& folder, const Arguments& arguments,
           const RobustnessSettings& settings, const std::vector<RobustnessResult>& results,
           const std::string& table) {
  make_folder(folder);
  nlohmann::json summary = to_json(results, settings);
  const BuildInfo build = build_info();
  summary["command"] = arguments.run.command_line;
  summary["version"] = build.version;
  summary["compiler"] = build.compiler;
  write_windows(folder / "windows.csv", results);
  write_json(folder / "robustness.json", summary);
  write_text(folder / "robustness.md", table);
}

ExitCode run(const Arguments& arguments) {
  const RobustnessSettings settings = settings_of(arguments);
  std::vector<RobustnessResult> results;
  ExitCode worst = ExitCode::kOk;
  for (const std::string& source : arguments.sources) {
    RunOptions options = arguments.run;
    options.source = source;
    options.use_source = [&](FrameSource& opened) {
      const std::vector<Frame> frames = read_frames(opened);
      results.push_back(measure_robustness(source, opened.info(), frames, settings, show_progress));
    };
    const ExitCode result = dispatch_run(options);
    if (result != ExitCode::kOk) worst = result;
  }
  const std::string table = robustness_table(results);
  write(arguments.run.out, arguments, settings, results, table);
  fmt::print("{}results in {}\n", table, arguments.run.out.string());
  return worst;
}

void add_options(CLI::App& command, Arguments& arguments) {
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
  add_range_options(command, arguments.run);
  add_picture_options(command, arguments.run);
}

}  // namespace

void register_robustness_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "robustness", "How often hand-held tracking succeeds on windows of recordings");
  const auto arguments = std::make_shared<Arguments>();
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
