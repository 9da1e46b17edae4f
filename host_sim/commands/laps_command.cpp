#include "host_sim/commands/laps_command.hpp"

#include <csignal>
#include <cstdio>
#include <memory>

#include <fmt/format.h>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/experiments/laps/laps.hpp"
#include "host_sim/io/interruption.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/sources/hall_source.hpp"

namespace cairn::host {
namespace {

constexpr int kLapFrames = 2400;
constexpr double kMostRms_m = 0.15;
constexpr double kMostNees = 10.0;
constexpr double kMostGrowth_mb = 2.0;  // after the second lap
constexpr std::size_t kSettled = 2;     // laps until every buffer has its size

struct Arguments {
  int laps = 50;
  int width = 320;
  std::uint64_t seed = 1;
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

HallOptions hall_of(const Arguments& arguments, int frames) {
  HallOptions hall;
  hall.width = arguments.width;
  hall.seed = arguments.seed;
  hall.frame_count = frames;
  return hall;
}

/// What holds of every lap.
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

void write_laps(const Arguments& arguments, const std::string& command_line,
                const std::vector<LapResult>& laps) {
  std::string table = laps_header();
  for (const LapResult& lap : laps) table += laps_row(lap);
  write_text(arguments.out / "laps.csv", table);
  nlohmann::json summary = {
      {"command", command_line},
      {"build", build_manifest()},
      {"laps", laps.size()},
      {"laps_asked", arguments.laps},
      {"limits",
       {{"map_rms_m", kMostRms_m}, {"nees", kMostNees}, {"memory_growth_mb", kMostGrowth_mb}}},
      {"holds", holds(laps)}};
  summary["interrupted_by"] =
      interrupted() == 0 ? nlohmann::json(nullptr) : nlohmann::json(interrupted());
  write_json(arguments.out / "summary.json", summary);
}

ExitCode run(const Arguments& arguments, const std::string& command_line) {
  Frame first;
  static_cast<void>(make_hall_source(hall_of(arguments, 1))->next(first));
  const std::unique_ptr<FrameSource> source =
      make_hall_source(hall_of(arguments, arguments.laps * kLapFrames));
  make_folder(arguments.out);
  const InterruptionGuard guard;
  fmt::print("{}", laps_header());
  std::vector<LapResult> done;
  const auto note = [&](const LapResult& lap) {
    fmt::print("{}", laps_row(lap));
    std::fflush(stdout);
    done.push_back(lap);
    write_laps(arguments, command_line, done);
  };
  const std::vector<LapResult> laps =
      run_laps(*source, tracker_at_start(first, arguments.seed), note);
  write_laps(arguments, command_line, laps);
  if (interrupted() == SIGINT) return ExitCode::kInterrupted;
  if (interrupted() != 0) return ExitCode::kTerminated;
  return holds(laps) ? ExitCode::kOk : ExitCode::kCheckFailed;
}

}  // namespace

void register_laps_command(CommandContext& context) {
  CLI::App* command = context.app.add_subcommand(
      "laps", "Drive lap after lap of the hall: error in the map, NEES, memory");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("--laps", arguments->laps, "Laps of 2,400 frames")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--width", arguments->width, "Width of the pictures, 320 or 640")
      ->check(CLI::IsMember({320, 640}))
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Seed of everything random")
      ->check(seed_number())
      ->capture_default_str();
  command->add_option("--out", arguments->out, "Folder for the results")->required();
  command->callback(
      [&context, arguments] { context.exit_code = run(*arguments, context.command_line); });
}

}  // namespace cairn::host
