#include "host_sim/commands/inject_command.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "cairn/base/config.hpp"

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/commands/run_kinds.hpp"
#include "host_sim/commands/source_options.hpp"
#include "host_sim/experiments/faults/fault_scene.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/options/run_options.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/sources/playback_source.hpp"

namespace cairn::host {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(FaultOutcome, id, component, mode, injected, expected, seen,
                                   counters, verdict)

namespace {

constexpr int kFrames = 600;
constexpr int kFrom = 300;
constexpr int kBriefFrames = 260;
constexpr int kBriefFrom = 90;
constexpr int kHandheldWorkLimit = 12000;

struct InjectArguments {
  std::vector<std::string> faults;
  bool list = false;
  bool brief = false;
  std::optional<int> frames;
  std::optional<int> from;
  Shard shard;
  RunOptions run;
};

void list_faults() {
  for (const FaultClass& fault : fault_classes()) fmt::print("{}  {}\n", fault.id, fault.title);
}

void check_faults(const std::vector<std::string>& wanted) {
  for (const std::string& id : wanted) {
    const bool known = std::any_of(fault_classes().begin(), fault_classes().end(),
                                   [&](const FaultClass& fault) { return id == fault.id; });
    if (!known) throw UsageError(fmt::format("--fault {}: expected F01 to F24 (see --list)", id));
  }
}

/// The source's tracker, started at the first true pose where that is known.
TrackerOptions tracker_of(const SourceInfo& info, const Frame& first, std::uint64_t seed) {
  TrackerOptions options;
  options.seed = seed;
  if (!info.odometry.has_value()) {
    options.mode = Mode::kHandheld;
    options.filter = kMonoFilter;
    return options;
  }
  start_at(first, options);
  return options;
}

FaultScene scene_of(FrameSource& source, const InjectArguments& arguments) {
  std::vector<Frame> frames = read_frames(source);
  const SourceInfo& info = source.info();
  FaultSettings settings;
  settings.brief = arguments.brief;
  settings.seed = arguments.run.seed;
  settings.from = arguments.from.value_or(arguments.brief ? kBriefFrom : kFrom);
  if (static_cast<int>(frames.size()) <= settings.from) {
    throw InputError(info.name, fmt::format("expected more than the {} frames before a fault, "
                                            "found {}",
                                            settings.from, frames.size()));
  }
  if (info.camera.width > DefaultConfig::kMaxImageWidth ||
      info.camera.height > DefaultConfig::kMaxImageHeight) {
    throw InputError(info.name,
                     fmt::format("expected pictures of at most {}x{}, found {}x{}: use --scale",
                                 DefaultConfig::kMaxImageWidth, DefaultConfig::kMaxImageHeight,
                                 info.camera.width, info.camera.height));
  }
  const TrackerOptions options = tracker_of(info, frames.front(), settings.seed);
  if (options.mode == Mode::kHandheld) settings.work_limit = kHandheldWorkLimit;
  return FaultScene(info, std::move(frames), options, settings);
}

void print(const FaultOutcome& outcome) {
  fmt::print("{} {:8} {} {}: {} | expected: {} | seen: {} | counters: {}\n", outcome.id,
             to_string(outcome.verdict), to_string(outcome.component), to_string(outcome.mode),
             outcome.injected, outcome.expected, outcome.seen,
             outcome.counters.empty() ? "-" : outcome.counters);
  std::fflush(stdout);
}

std::string quoted(const std::string& field) {
  std::string result = "\"";
  for (const char c : field) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + "\"";
}

std::string table_of(const std::vector<FaultOutcome>& outcomes) {
  std::string table = "fault,result,component,mode,injected,expected,seen,counters\n";
  for (const FaultOutcome& o : outcomes) {
    table += fmt::format("{},{},{},{},{},{},{},{}\n", o.id, to_string(o.verdict),
                         to_string(o.component), to_string(o.mode), quoted(o.injected),
                         quoted(o.expected), quoted(o.seen), quoted(o.counters));
  }
  return table;
}

/// A piece for each class of faults that is wanted and of the shard.
void inject_all(const FaultScene& scene, const InjectArguments& arguments, PartialResult& part) {
  const std::vector<FaultClass>& classes = fault_classes();
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const bool asked = std::find(arguments.faults.begin(), arguments.faults.end(), classes[i].id) !=
                       arguments.faults.end();
    if ((!arguments.faults.empty() && !asked) || !arguments.shard.has(i)) continue;
    std::vector<FaultOutcome> outcomes = classes[i].inject(scene);
    for (FaultOutcome& outcome : outcomes) {
      outcome.id = classes[i].id;
      print(outcome);
    }
    part.pieces[static_cast<int>(i)] = outcomes;
  }
}

std::vector<FaultOutcome> outcomes_of(const PartialResult& part) {
  std::vector<FaultOutcome> outcomes;
  for (const auto& [number, piece] : part.pieces) {
    for (const nlohmann::json& outcome : piece) outcomes.push_back(outcome.get<FaultOutcome>());
  }
  return outcomes;
}

ExitCode summarise(const std::vector<FaultOutcome>& outcomes) {
  const auto count = [&](FaultVerdict verdict) {
    return std::count_if(outcomes.begin(), outcomes.end(),
                         [&](const FaultOutcome& o) { return o.verdict == verdict; });
  };
  const auto failed = count(FaultVerdict::kFail);
  fmt::print("{} injections: {} pass, {} fail, {} reported, {} skipped\n", outcomes.size(),
             count(FaultVerdict::kPass), failed, count(FaultVerdict::kReported),
             count(FaultVerdict::kSkipped));
  return failed == 0 ? ExitCode::kOk : ExitCode::kCheckFailed;
}

nlohmann::json settings_json(const RunOptions& options, const InjectArguments& arguments) {
  return {{"source", options.source},
          {"faults", arguments.faults},
          {"brief", arguments.brief},
          {"frames", *options.max_frames},
          {"from", arguments.from.value_or(-1)},
          {"first_frame", options.first_frame.value_or(-1)},
          {"seed", options.seed}};
}

ExitCode run(const InjectArguments& arguments) {
  if (arguments.list) {
    list_faults();
    return ExitCode::kOk;
  }
  check_faults(arguments.faults);
  if (!arguments.shard.whole() && arguments.run.out.empty()) {
    throw UsageError("--shard needs --out, the folder that merge reads");
  }
  if (arguments.shard.whole() && !arguments.run.out.empty()) {
    (void)OutputFile(arguments.run.out);  // refused before the work where it cannot be written
  }
  RunOptions options = arguments.run;
  options.max_frames = arguments.frames.value_or(arguments.brief ? kBriefFrames : kFrames);
  ExitCode result = ExitCode::kOk;
  options.use_source = [&](FrameSource& source) {
    const FaultScene scene = scene_of(source, arguments);
    PartialResult part = make_partial("inject", settings_json(options, arguments), arguments.shard);
    inject_all(scene, arguments, part);
    if (arguments.shard.whole()) {
      const std::vector<FaultOutcome> outcomes = outcomes_of(part);
      if (!arguments.run.out.empty()) write_text(arguments.run.out, table_of(outcomes));
      result = summarise(outcomes);
    } else {
      const Conclusion conclusion{arguments.run.out, arguments.run.command_line};
      result = conclude_or_leave(part, conclusion, conclude_inject);
    }
  };
  const ExitCode source_result = dispatch_run(options);
  return source_result == ExitCode::kOk ? result : source_result;
}

void add_options(CLI::App& command, InjectArguments& arguments) {
  arguments.run.source = "hall-small";
  command.add_option("SOURCE", arguments.run.source, "Source with pictures, as for `run`")
      ->capture_default_str();
  command.add_option("--fault", arguments.faults, "Only these: F01 to F24, separated by commas")
      ->delimiter(',');
  command.add_flag("--list", arguments.list, "Name the faults and end");
  command.add_flag("--brief", arguments.brief, "Fewer frames, draws and variants: seconds a fault");
  command.add_option("--out", arguments.run.out,
                     "File for the results (CSV); with --shard a folder");
  add_shard_option(command, arguments.shard);
  command.add_option("--frames", arguments.frames, "Frames of the source that are used")
      ->check(above_zero());
  command.add_option("--from", arguments.from, "Frames before a fault")->check(above_zero());
  command.add_option("--seed", arguments.run.seed, "Seed of everything random")
      ->check(seed_number())
      ->capture_default_str();
  command.add_option("--first-frame", arguments.run.first_frame, "Number of the first frame");
  add_picture_options(command, arguments.run);
  add_odometry_options(command, arguments.run);
}

}  // namespace

ExitCode conclude_inject(const PartialResult& whole, const Conclusion& conclusion) {
  const std::vector<FaultOutcome> outcomes = outcomes_of(whole);
  for (const FaultOutcome& outcome : outcomes) print(outcome);
  write_text(conclusion.out / "faults.csv", table_of(outcomes));
  return summarise(outcomes);
}

void register_inject_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "inject", "Put faults into a tracker's inputs and say what becomes of them");
  const auto arguments = std::make_shared<InjectArguments>();
  add_options(*command, *arguments);
  command->callback([&context, command, arguments] {
    arguments->run.command_line = context.command_line;
    arguments->run.given = given_options(*command);
    context.exit_code = run(*arguments);
  });
}

}  // namespace cairn::host
