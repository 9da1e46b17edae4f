#include "host_sim/commands/timing_command.hpp"

#include <fstream>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/commands/run_kinds.hpp"
#include "host_sim/commands/source_options.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/options/run_options.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/world/stress_scene.hpp"

namespace cairn::host {
namespace {

struct Arguments {
  RunOptions run;
  TimingOptions timing;
  bool worst_case = false;
};

nlohmann::json read_json(const std::filesystem::path& path) {
  return nlohmann::json::parse(std::ifstream(path));
}

/// Every named stress scene, in both modes.
ExitCode time_worst_cases(const Arguments& arguments) {
  ExitCode worst = ExitCode::kOk;
  std::string table =
      "| scene | mode | p50, ms | p99, ms | max, ms | instructions, median | worst |\n"
      "| --- | --- | ---: | ---: | ---: | ---: | ---: |\n";
  for (const NamedStressScene& scene : named_stress_scenes()) {
    for (const char* mode : {"vehicle", "handheld"}) {
      const bool handheld = mode[0] == 'h';
      RunOptions options = arguments.run;
      options.source = fmt::format("stress:{}{}", scene.name, handheld ? ",handheld=1" : "");
      options.out = arguments.run.out / fmt::format("{}-{}", scene.name, mode);
      options.mode.clear();
      fmt::print("{} ({}): {}\n", scene.name, mode, scene.what);
      const ExitCode result = dispatch_run(options);
      if (result != ExitCode::kOk) worst = result;
      const nlohmann::json summary = read_json(options.out / "timing.json");
      const nlohmann::json& ms = summary["latency_ms"]["cpu"];
      const nlohmann::json& counts = summary["instructions"];
      const auto millions = [&counts](const char* key) {
        return counts.is_null() ? std::string("-")
                                : fmt::format("{:.3f} M", counts[key].get<double>() * 1e-6);
      };
      table += fmt::format("| {} | {} | {:.3f} | {:.3f} | {:.3f} | {} | {} |\n", scene.name, mode,
                           ms["p50"].get<double>(), ms["p99"].get<double>(),
                           ms["max"].get<double>(), millions("median"), millions("worst"));
    }
  }
  write_text(arguments.run.out / "timing.md", table);
  fmt::print("\n{}", table);
  return worst;
}

ExitCode run(Arguments& arguments) {
  if (arguments.worst_case && !arguments.run.source.empty()) {
    throw UsageError("--worst-case has sources of its own: give no SOURCE");
  }
  if (arguments.run.source.empty()) arguments.run.source = "hall";
  arguments.run.video = false;
  arguments.run.timing = arguments.timing;
  return arguments.worst_case ? time_worst_cases(arguments) : dispatch_run(arguments.run);
}

}  // namespace

void register_timing_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "timing", "Time and instructions of every frame, beside the paper's Table 1");
  const auto arguments = std::make_shared<Arguments>();
  RunOptions& run_options = arguments->run;
  command->add_option("SOURCE", run_options.source, "As for `run`; the hall unless given");
  command->add_option("--out", run_options.out, "Folder for the results")->required();
  command->add_flag("--worst-case", arguments->worst_case,
                    "Instead of a source, every stress scene");
  command->add_option("--mode", run_options.mode, "How the camera moves")
      ->check(CLI::IsMember({"vehicle", "handheld"}));
  command->add_option("--filter", run_options.filter, "Filter")
      ->check(CLI::IsMember({"group-iekf", "lifted-iekf", "ekf", "mono", "window"}));
  add_range_options(*command, run_options);
  command->add_option("--seed", run_options.seed, "Seed of everything random")
      ->check(seed_number());
  add_picture_options(*command, run_options);
  add_odometry_options(*command, run_options);
  command->add_option("--budget-ms", run_options.budget_ms, "Time budget of a frame, ms")
      ->check(above_zero())
      ->capture_default_str();
  command
      ->add_option("--counted-frames", arguments->timing.counted_frames,
                   "First frames whose instructions are counted (valgrind); 0: none")
      ->check(not_negative())
      ->capture_default_str();
  command
      ->add_option("--p99-below", arguments->timing.p99_below_ms,
                   "End with 1 when the 99th percentile of the time on the core is above this, ms")
      ->check(above_zero());
  command->callback([&context, command, arguments] {
    arguments->run.command_line = context.command_line;
    arguments->run.given = given_options(*command);
    context.exit_code = run(*arguments);
  });
}

}  // namespace cairn::host
