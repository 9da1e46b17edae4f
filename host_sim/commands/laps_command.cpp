#include "host_sim/commands/laps_command.hpp"

#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/experiments/laps/laps.hpp"
#include "host_sim/io/interruption.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/sources/hall_source.hpp"

namespace cairn::host {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(LapResult, lap, frames, tracked, lost, map_rms_m, map_worst_m,
                                   sigma_m, nees, worst_nees, filter_rms_m, filter_sigma_m,
                                   filter_nees, library, memory_mb, frame_ms)

namespace {

constexpr int kLapFrames = 2400;
constexpr double kMostRms_m = 0.15;
constexpr double kMostNees = 10.0;
constexpr double kMostGrowth_mb = 2.0;  // after the second lap
constexpr std::size_t kSettled = 2;     // laps until every buffer has its size

struct LapsArguments {
  int laps = 50;
  int width = 320;
  std::uint64_t seed = 1;
  int seeds = 1;
  Shard shard;
  std::filesystem::path out;
};

TrackerOptions tracker_at_start(const Frame& first, std::uint64_t seed) {
  TrackerOptions options;
  options.seed = seed;
  const Rigid<double>& truth = *first.true_T_world_vehicle;
  const Vector3<double> forward = truth.rotation * Vector3<double>::UnitX();
  options.start_x_m = truth.translation.x();
  options.start_y_m = truth.translation.y();
  options.start_theta_rad = cairn::atan2(forward.y(), forward.x());
  return options;
}

HallOptions hall_of(const LapsArguments& arguments, std::uint64_t seed, int frames) {
  HallOptions hall;
  hall.width = arguments.width;
  hall.seed = seed;
  hall.frame_count = frames;
  return hall;
}

/// What holds of every lap of one seed.
bool holds(const std::vector<LapResult>& laps) {
  bool good = !laps.empty();
  for (const LapResult& lap : laps) {
    good = good && lap.map_rms_m <= kMostRms_m && lap.nees <= kMostNees;
  }
  if (laps.size() > kSettled) {
    good = good && laps.back().memory_mb - laps[kSettled - 1].memory_mb <= kMostGrowth_mb;
  }
  return good;
}

/// laps.csv and summary.json; returns whether all seeds hold.
bool write_laps(const PartialResult& part, const Conclusion& conclusion) {
  std::string table = "seed," + laps_header();
  bool good = !part.pieces.empty();
  std::size_t count = 0;
  for (const auto& [number, piece] : part.pieces) {
    const auto seed =
        part.settings.at("seed").get<std::uint64_t>() + static_cast<std::uint64_t>(number);
    const auto laps = piece.get<std::vector<LapResult>>();
    for (const LapResult& lap : laps) table += fmt::format("{},{}", seed, laps_row(lap));
    good = good && holds(laps);
    count += laps.size();
  }
  make_folder(conclusion.out);
  write_text(conclusion.out / "laps.csv", table);
  nlohmann::json summary = {
      {"command", conclusion.command_line},
      {"build", build_manifest()},
      {"seeds", part.pieces.size()},
      {"laps", count},
      {"laps_asked", part.settings.at("laps")},
      {"limits",
       {{"map_rms_m", kMostRms_m}, {"nees", kMostNees}, {"memory_growth_mb", kMostGrowth_mb}}},
      {"holds", good}};
  summary["interrupted_by"] =
      interrupted() == 0 ? nlohmann::json(nullptr) : nlohmann::json(interrupted());
  write_json(conclusion.out / "summary.json", summary);
  return good;
}

/// The laps of one seed as a piece of `part`, written as each ends.
void drive(const LapsArguments& arguments, int number, const Conclusion& conclusion,
           PartialResult& part) {
  const std::uint64_t seed = arguments.seed + static_cast<std::uint64_t>(number);
  Frame first;
  static_cast<void>(make_hall_source(hall_of(arguments, seed, 1))->next(first));
  const std::unique_ptr<FrameSource> source =
      make_hall_source(hall_of(arguments, seed, arguments.laps * kLapFrames));
  std::vector<LapResult> done;
  const auto note = [&](const LapResult& lap) {
    fmt::print("{},{}", seed, laps_row(lap));
    std::fflush(stdout);
    done.push_back(lap);
    part.pieces[number] = done;
    if (arguments.shard.whole()) static_cast<void>(write_laps(part, conclusion));
  };
  part.pieces[number] = run_laps(*source, tracker_at_start(first, seed), note);
}

ExitCode run(const LapsArguments& arguments, const std::string& command_line) {
  make_folder(arguments.out);
  const InterruptionGuard guard;
  PartialResult part = make_partial("laps",
                                    {{"laps", arguments.laps},
                                     {"width", arguments.width},
                                     {"seed", arguments.seed},
                                     {"seeds", arguments.seeds}},
                                    arguments.shard);
  const Conclusion conclusion{arguments.out, command_line};
  fmt::print("seed,{}", laps_header());
  for (int number = 0; number < arguments.seeds && interrupted() == 0; ++number) {
    if (!arguments.shard.has(static_cast<std::size_t>(number))) continue;
    drive(arguments, number, conclusion, part);
  }
  if (interrupted() != 0) {
    if (arguments.shard.whole()) static_cast<void>(write_laps(part, conclusion));
    return interrupted_by(interrupted());
  }
  return conclude_or_leave(part, conclusion, conclude_laps);
}

}  // namespace

ExitCode conclude_laps(const PartialResult& whole, const Conclusion& conclusion) {
  return write_laps(whole, conclusion) ? ExitCode::kOk : ExitCode::kCheckFailed;
}

void register_laps_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "laps", "Drive lap after lap of the hall: error in the map, NEES, memory");
  const auto arguments = std::make_shared<LapsArguments>();
  command->add_option("--laps", arguments->laps, "Laps of 2,400 frames")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--width", arguments->width, "Width of the pictures, 320 or 640")
      ->check(CLI::IsMember({320, 640}))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "First seed of everything random")
      ->check(seed_number())
      ->capture_default_str();
  command->add_option("--seeds", arguments->seeds, "Number of seeds, one drive each")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  add_shard_option(*command, arguments->shard);
  command->add_option("--out", arguments->out, "Folder for the results")->required();
  command->callback(
      [&context, arguments] { context.exit_code = run(*arguments, context.command_line); });
}

}  // namespace cairn::host
