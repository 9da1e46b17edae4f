#include "host_sim/commands/miscalibration_command.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/commands/run_kinds.hpp"
#include "host_sim/commands/source_options.hpp"
#include "host_sim/experiments/miscalibration/miscalibration.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/interruption.hpp"
#include "host_sim/options/run_options.hpp"
#include "host_sim/reports/run_folder.hpp"

namespace cairn::host {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(MiscalibrationResult, told, frames, tracked, wrong,
                                   suspect_frames, first_s, said)

namespace {

constexpr double kSoon_s = 10.0;
constexpr int kDriveFrames = 1200;

struct MiscalibrationArguments {
  RunOptions run;
  int seeds = 1;
  Shard shard;
};

/// What the drives of all seeds came to, of one thing that was told wrongly.
struct Told {
  std::string name;
  int drives = 0;
  int frames = 0;
  int tracked = 0;
  int wrong = 0;
  int soon = 0;
  std::vector<double> first_s;  ///< of the drives in which something was said
  std::vector<std::string> said;
};

std::vector<Told> tables_of(const PartialResult& part) {
  std::vector<Told> table;
  for (const auto& [number, piece] : part.pieces) {
    for (const nlohmann::json& entry : piece) {
      const auto result = entry.get<MiscalibrationResult>();
      auto row = std::find_if(table.begin(), table.end(),
                              [&](const Told& told) { return told.name == result.told; });
      if (row == table.end()) row = table.insert(row, Told{result.told, 0, 0, 0, 0, 0, {}, {}});
      ++row->drives;
      row->frames += result.frames;
      row->tracked += result.tracked;
      row->wrong += result.wrong;
      if (result.first_s < 0.0) continue;
      row->soon += result.first_s <= kSoon_s ? 1 : 0;
      row->first_s.push_back(result.first_s);
      row->said.push_back(result.said);
    }
  }
  return table;
}

/// Median and last of the times, and one estimate for each kind of thing that was said.
std::string line_of(Told told) {
  std::string times = "-";
  std::string said = "nothing";
  if (!told.first_s.empty()) {
    std::sort(told.first_s.begin(), told.first_s.end());
    times =
        fmt::format("{:.1f} ({:.1f})", told.first_s[told.first_s.size() / 2], told.first_s.back());
    said.clear();
    std::string kinds;
    for (const std::string& text : told.said) {
      const std::string kind = text.substr(0, text.find(' '));
      if (kinds.find(kind + ";") != std::string::npos) continue;
      kinds += kind + ";";
      const auto same = std::count_if(told.said.begin(), told.said.end(), [&](const auto& other) {
        return other.substr(0, other.find(' ')) == kind;
      });
      said += fmt::format("{}{} of {}: {}", said.empty() ? "" : "; ", same, told.drives, text);
    }
  }
  return fmt::format("| {} | {} of {} | {} | {} | {} | {} of {} |\n", told.name,
                     told.first_s.size(), told.drives, told.soon, times, said, told.wrong,
                     told.tracked);
}

std::string markdown_of(const PartialResult& part) {
  std::string text =
      "| told wrongly | said | of these within 10 s | first after, s: median (last) | what, for "
      "example | called tracking and wrong |\n| --- | --- | --- | --- | --- | --- |\n";
  for (const Told& told : tables_of(part)) text += line_of(told);
  return text;
}

std::string csv_of(const PartialResult& part) {
  std::string text = "seed,told,frames,tracked,wrong,suspect_frames,first_s,said\n";
  const auto first = part.settings.at("seed").get<std::uint64_t>();
  for (const auto& [number, piece] : part.pieces) {
    for (const nlohmann::json& entry : piece) {
      const auto r = entry.get<MiscalibrationResult>();
      text +=
          fmt::format("{},{},{},{},{},{},{:.3f},{}\n", first + static_cast<std::uint64_t>(number),
                      r.told, r.frames, r.tracked, r.wrong, r.suspect_frames, r.first_s, r.said);
    }
  }
  return text;
}

/// Whether everything wrong was told in every drive, and nothing where nothing was.
bool holds(const PartialResult& part) {
  bool good = !part.pieces.empty();
  for (const Told& told : tables_of(part)) {
    const bool right = told.name == miscalibrations().front().name;
    good = good && (right ? told.first_s.empty() : told.soon == told.drives);
  }
  return good;
}

ExitCode write_results(const PartialResult& part, const Conclusion& conclusion) {
  make_folder(conclusion.out);
  const std::string table = markdown_of(part);
  fmt::print("{}", table);
  write_text(conclusion.out / "miscalibration.csv", csv_of(part));
  write_text(conclusion.out / "miscalibration.md", table);
  write_json(conclusion.out / "summary.json", {{"command", conclusion.command_line},
                                               {"build", build_manifest()},
                                               {"settings", part.settings},
                                               {"drives", part.pieces.size()},
                                               {"holds", holds(part)}});
  return ExitCode::kOk;
}

ExitCode run(const MiscalibrationArguments& arguments) {
  const InterruptionGuard guard;
  RunOptions options = arguments.run;
  if (!options.max_frames) options.max_frames = kDriveFrames;
  PartialResult part = make_partial("miscalibration",
                                    {{"source", options.source},
                                     {"frames", *options.max_frames},
                                     {"first_frame", options.first_frame.value_or(-1)},
                                     {"seed", options.seed},
                                     {"seeds", arguments.seeds}},
                                    arguments.shard);
  const std::uint64_t first = options.seed;
  for (int number = 0; number < arguments.seeds && interrupted() == 0; ++number) {
    if (!arguments.shard.has(static_cast<std::size_t>(number))) continue;
    options.seed = first + static_cast<std::uint64_t>(number);
    options.use_source = [&](FrameSource& source) {
      part.pieces[number] = tell_wrongly(source, miscalibrations(), options.seed);
    };
    const ExitCode code = dispatch_run(options);
    if (code != ExitCode::kOk) return code;
  }
  if (interrupted() != 0) {
    return interrupted_by(interrupted());
  }
  return conclude_or_leave(part, {options.out, options.command_line}, conclude_miscalibration);
}

}  // namespace

ExitCode conclude_miscalibration(const PartialResult& whole, const Conclusion& conclusion) {
  return write_results(whole, conclusion);
}

void register_miscalibration_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "miscalibration", "Tell a vehicle's tracker wrong calibrations and see what it says of them");
  const auto arguments = std::make_shared<MiscalibrationArguments>();
  RunOptions& options = arguments->run;
  options.source = "hall";
  command->add_option("SOURCE", options.source, "As for `run`, in vehicle mode, with true poses")
      ->capture_default_str();
  command->add_option("--seed", options.seed, "First seed of everything random")
      ->check(seed_number())
      ->capture_default_str();
  command->add_option("--seeds", arguments->seeds, "Number of seeds, a drive each")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--out", options.out, "Folder for the results")->required();
  add_shard_option(*command, arguments->shard);
  add_range_options(*command, options);
  add_picture_options(*command, options);
  add_odometry_options(*command, options);
  command->callback([&context, command, arguments] {
    arguments->run.mode = "vehicle";
    arguments->run.command_line = context.command_line;
    arguments->run.given = given_options(*command);
    context.exit_code = run(*arguments);
  });
}

}  // namespace cairn::host
