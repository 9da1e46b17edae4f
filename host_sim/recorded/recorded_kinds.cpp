#include "host_sim/recorded/recorded_kinds.hpp"

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/recorded/recorded_files.hpp"

namespace cairn::host {
namespace {

RecordingProfile profile_of(const RunOptions& options) {
  if (options.profile == "calibrated") return RecordingProfile::kCalibrated;
  return options.profile == "stated" ? RecordingProfile::kStated : RecordingProfile::kPlain;
}

void check_options(const RunOptions& options) {
  if (options.mode == "handheld") {
    throw UsageError("--mode handheld: a landmark recording is driven by a vehicle");
  }
  if (!options.fading.empty()) throw UsageError("--fading: only for --filter mono");
}

ExitCode run(const Recording& recording, const RunOptions& options) {
  check_options(options);
  RecordedRunOptions recorded;
  recorded.filter = options.filter.empty() ? kDefaultVehicleFilter : options.filter;
  recorded.seed = options.seed;
  recorded.budget_ms = options.budget_ms;
  recorded.start_heading_variance = options.start_heading_variance;
  recorded.start_position_variance = options.start_position_variance;
  if (options.max_frames) recorded.longest_s = 0.1 * (*options.max_frames - 1);
  const RecordedRun result = run_recorded(recording, recorded);
  write_recorded_run(recording, recorded, result, options.command_line, options.out);

  const RecordedErrors e = recorded_errors(recording, result);
  fmt::print("{} with {}: {} samples, {} landmarks\n", recording.name, recorded.filter,
             result.samples.size(), result.landmarks.size());
  if (recording.truth_has_heading) {
    fmt::print("  position RMSE {:.4f} m, aligned {:.4f} m, heading {:.4f} rad, NEES {:.2f}\n",
               e.position_rmse_m, e.aligned_rmse_m, e.heading_rmse_rad, e.nees_mean);
    fmt::print("  map RMSE {:.4f} m, aligned {:.4f} m, landmark NEES {:.2f}\n", e.map_rmse_m,
               e.map_aligned_rmse_m, e.map_nees_mean);
  } else {
    fmt::print("  to GPS, aligned: median {:.2f} m, 95 % {:.2f} m\n", e.aligned_median_m,
               e.aligned_p95_m);
  }
  fmt::print("  {:.2f} us per prediction, {:.1f} us per scan (99 %: {:.1f})\nresults in {}\n",
             result.predict.mean(), result.scan.mean(), result.scan.quantile(0.99),
             options.out.string());
  return ExitCode::kOk;
}

}  // namespace

ExitCode run_lost_in_the_woods(const RunOptions& options, const std::string& argument) {
  return run(read_lost_in_the_woods(argument, profile_of(options)), options);
}

ExitCode run_mrclam(const RunOptions& options, const std::string& argument) {
  const std::size_t colon = argument.rfind(':');
  const std::string robot = colon == std::string::npos ? "" : argument.substr(colon + 1);
  if (robot.size() != 1 || robot[0] < '1' || robot[0] > '5') {
    throw UsageError(fmt::format(
        "source 'mrclam:{}': expected mrclam:DIR:ROBOT with a robot from 1 to 5", argument));
  }
  return run(read_mrclam(argument.substr(0, colon), robot[0] - '0', profile_of(options)), options);
}

ExitCode run_victoria_park(const RunOptions& options, const std::string& argument) {
  if (options.profile == "calibrated") {
    throw UsageError("--profile calibrated: victoria-park has none");
  }
  return run(read_victoria_park(argument), options);
}

}  // namespace cairn::host
