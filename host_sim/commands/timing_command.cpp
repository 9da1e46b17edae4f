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

struct TimingArguments {
  RunOptions run;
  TimingOptions timing;
  bool worst_case = false;
  Shard shard;
};

nlohmann::json read_json(const std::filesystem::path& path) {
  return nlohmann::json::parse(std::ifstream(path));
}

/// A row of the table of worst cases.
nlohmann::json time_worst_case(const TimingArguments& arguments, const NamedStressScene& scene,
                               bool handheld, ExitCode& worst) {
  const char* mode = handheld ? "handheld" : "vehicle";
  RunOptions options = arguments.run;
  options.source = fmt::format("stress:{}{}", scene.name, handheld ? ",handheld=1" : "");
  options.out = arguments.run.out / fmt::format("{}-{}", scene.name, mode);
  options.mode.clear();
  fmt::print("{} ({}): {}\n", scene.name, mode, scene.what);
  const ExitCode result = dispatch_run(options);
  if (result != ExitCode::kOk) worst = result;
  const nlohmann::json summary = read_json(options.out / "timing.json");
  return {{"scene", scene.name},
          {"mode", mode},
          {"ms", summary["latency_ms"]["cpu"]},
          {"instructions", summary["instructions"]}};
}

/// Every named stress scene, in both modes.
ExitCode time_worst_cases(const TimingArguments& arguments) {
  ExitCode worst = ExitCode::kOk;
  PartialResult part = make_partial(
      "timing", {{"counted_frames", arguments.timing.counted_frames}, {"seed", arguments.run.seed}},
      arguments.shard);
  std::size_t number = 0;
  for (const NamedStressScene& scene : named_stress_scenes()) {
    for (const bool handheld : {false, true}) {
      if (arguments.shard.has(number)) {
        part.pieces[static_cast<int>(number)] = time_worst_case(arguments, scene, handheld, worst);
      }
      ++number;
    }
  }
  const Conclusion conclusion{arguments.run.out, arguments.run.command_line};
  const ExitCode concluded = conclude_or_leave(part, conclusion, conclude_timing);
  return worst == ExitCode::kOk ? concluded : worst;
}

ExitCode run(TimingArguments& arguments) {
  if (arguments.worst_case && !arguments.run.source.empty()) {
    throw UsageError("--worst-case has sources of its own: give no SOURCE");
  }
  if (!arguments.worst_case && !arguments.shard.whole()) {
    throw UsageError("--shard goes with --worst-case alone: a single run has no parts");
  }
  if (arguments.run.source.empty()) arguments.run.source = "hall";
  arguments.run.video = false;
  arguments.run.timing = arguments.timing;
  return arguments.worst_case ? time_worst_cases(arguments) : dispatch_run(arguments.run);
}

}  // namespace

ExitCode conclude_timing(const PartialResult& whole, const Conclusion& conclusion) {
  std::string table =
      "| scene | mode | p50, ms | p99, ms | max, ms | instructions, median | worst |\n"
      "| --- | --- | ---: | ---: | ---: | ---: | ---: |\n";
  for (const auto& [number, row] : whole.pieces) {
    const nlohmann::json& ms = row.at("ms");
    const nlohmann::json& counts = row.at("instructions");
    const auto millions = [&counts](const char* key) {
      return counts.is_null() ? std::string("-")
                              : fmt::format("{:.3f} M", counts.at(key).get<double>() * 1e-6);
    };
    table += fmt::format("| {} | {} | {:.3f} | {:.3f} | {:.3f} | {} | {} |\n",
                         row.at("scene").get<std::string>(), row.at("mode").get<std::string>(),
                         ms.at("p50").get<double>(), ms.at("p99").get<double>(),
                         ms.at("max").get<double>(), millions("median"), millions("worst"));
  }
  write_text(conclusion.out / "timing.md", table);
  fmt::print("\n{}", table);
  return ExitCode::kOk;
}

void register_timing_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "timing", "Time and instructions of every frame, beside the paper's Table 1");
  const auto arguments = std::make_shared<TimingArguments>();
  RunOptions& run_options = arguments->run;
  command->add_option("SOURCE", run_options.source, "As for `run`; the hall unless given");
  command->add_option("--out", run_options.out, "Folder for the results")->required();
  command->add_flag("--worst-case", arguments->worst_case,
                    "Instead of a source, every stress scene");
  add_shard_option(*command, arguments->shard);
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
