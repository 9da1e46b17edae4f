#include "host_sim/commands/tracker_of_run.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host_sim/io/input_error.hpp"
#include "host_sim/io/suspension.hpp"
#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

/// The first of `names` that the command line gives.
std::string first_of(std::initializer_list<const char*> names,
                     const std::vector<std::string>& given) {
  for (const char* name : names) {
    if (std::find(given.begin(), given.end(), name) != given.end()) return name;
  }
  return {};
}

std::string filter_of(const RunOptions& options, Mode mode) {
  if (options.filter.empty()) {
    return mode == Mode::kVehicle ? kDefaultVehicleFilter : kDefaultHandheldFilter;
  }
  const bool handheld = options.filter == kMonoFilter || options.filter == kWindowFilter;
  if (mode == Mode::kHandheld && !handheld) {
    throw UsageError(
        fmt::format("--filter {}: handheld mode runs with mono or window", options.filter));
  }
  const bool without_camera = options.filter == "ekf-fixed";
  if (mode == Mode::kVehicle && (handheld || without_camera)) {
    throw UsageError(
        fmt::format("--filter {}: vehicle mode runs with group-iekf, group-iekf-fixed, lifted-iekf "
                    "or ekf",
                    options.filter));
  }
  return options.filter;
}

/// What the window has no use for.
void check_window_options(const RunOptions& options) {
  const HandheldOptions& handheld = options.handheld;
  if (!handheld.measurement.empty() || handheld.corner_score || handheld.estimate_focal_length) {
    throw UsageError(
        "--measurement, --corner-score, --estimate-focal-length: only for --filter mono");
  }
  if (!options.fading.empty()) throw UsageError("--fading: only for --filter mono");
}

/// Vehicle runs start at the first true pose; a variance that is asked for draws the start error.
void set_start(const RunOptions& options, const Frame& first, TrackerOptions& tracker) {
  if (first.true_T_world_vehicle.has_value()) {
    const Rigid<double>& truth = *first.true_T_world_vehicle;
    const Vector3<double> forward = truth.rotation * Vector3<double>::UnitX();
    tracker.start_x_m = truth.translation.x();
    tracker.start_y_m = truth.translation.y();
    tracker.start_theta_rad = cairn::atan2(forward.y(), forward.x());
  }
  GaussianRandom random(options.seed ^ 0x57a27ULL);
  if (options.start_position_variance.has_value()) {
    tracker.start_position_variance = *options.start_position_variance;
    tracker.start_x_m += random.normal(std::sqrt(*options.start_position_variance));
    tracker.start_y_m += random.normal(std::sqrt(*options.start_position_variance));
  }
  if (options.start_heading_variance.has_value()) {
    tracker.start_heading_variance = *options.start_heading_variance;
    tracker.start_theta_rad = wrap_angle(tracker.start_theta_rad +
                                         random.normal(std::sqrt(*options.start_heading_variance)));
  }
}

/// How the vehicle's body tilts: as the source says, or as the options do.
TiltParameters<double> tilt_of(const RunOptions& options, const SourceInfo& source,
                               const std::string& filter) {
  const bool asked = !options.suspension.empty() || options.tilt_sigma_rad.has_value() ||
                     options.tilt_time_constant_s.has_value();
  TiltParameters<double> tilt = source.tilt;
  if (!options.suspension.empty()) tilt = find_suspension(options.suspension)->tilt;
  if (options.tilt_sigma_rad) tilt.sigma_pitch_rad = tilt.sigma_roll_rad = *options.tilt_sigma_rad;
  if (options.tilt_time_constant_s) tilt.time_constant_s = *options.tilt_time_constant_s;
  if (filter != "lifted-iekf" || !tilt.tilts()) return tilt;
  if (asked) throw UsageError("--filter lifted-iekf: has no states of a tilt");
  return TiltParameters<double>::flat_floor();
}

/// How well the direction of travel is known: one filter alone estimates it.
std::optional<double> travel_sigma_of(const RunOptions& options, const TrackerOptions& tracker) {
  if (!options.travel_sigma_rad) return std::nullopt;
  if (tracker.mode == Mode::kHandheld) throw UsageError("--travel-sigma: only for --mode vehicle");
  if (tracker.filter != kDefaultVehicleFilter && *options.travel_sigma_rad > 0.0) {
    throw UsageError(
        fmt::format("--travel-sigma: --filter {} has no state of the direction of "
                    "travel, group-iekf alone has",
                    tracker.filter));
  }
  return options.travel_sigma_rad;
}

}  // namespace

Mode mode_of(const RunOptions& options, const SourceInfo& source) {
  if (options.mode.empty()) return source.odometry.has_value() ? Mode::kVehicle : Mode::kHandheld;
  const Mode mode = options.mode == "vehicle" ? Mode::kVehicle : Mode::kHandheld;
  if (mode == Mode::kVehicle && !source.odometry.has_value()) {
    throw UsageError(fmt::format("--mode vehicle: source '{}' has no odometry", source.name));
  }
  return mode;
}

TrackerOptions tracker_options(const RunOptions& options, const SourceInfo& source,
                               const Frame& first) {
  TrackerOptions tracker;
  tracker.mode = mode_of(options, source);
  tracker.filter = filter_of(options, tracker.mode);
  tracker.fading = options.fading;
  tracker.budget_ms = options.budget_ms;
  tracker.seed = options.seed;
  tracker.handheld = options.handheld;
  tracker.work_limit = options.work_limit;
  if (tracker.filter == kWindowFilter) check_window_options(options);
  if (tracker.filter == kMonoFilter && source.gyro) {
    throw UsageError("--gyro: only for --filter window, or in vehicle mode");
  }
  if (tracker.filter == kMonoFilter && options.handheld.focal_sigma) {
    throw UsageError("--focal-sigma: only for --filter window");
  }
  if (tracker.filter == kMonoFilter && options.handheld.row_time_s) {
    throw UsageError("--row-time: only for --filter window");
  }
  if (tracker.filter != kWindowFilter && !source.readout.instant()) {
    fmt::print(stderr,
               "cairn_sim: warning: row_time and column_time of the camera are used by "
               "--mode handheld --filter window alone\n");
  }
  if (tracker.mode == Mode::kVehicle && !options.handheld.is_default()) {
    throw UsageError(
        fmt::format("{}: only for --mode handheld",
                    first_of({"--measurement", "--corner-score", "--sigma-px", "--focal-error",
                              "--estimate-focal-length", "--focal-sigma", "--row-time"},
                             options.given)));
  }
  if (tracker.mode == Mode::kVehicle && !options.fading.empty()) {
    throw UsageError("--fading: only for --filter mono");
  }
  if (tracker.mode == Mode::kHandheld &&
      (options.start_heading_variance || options.start_position_variance)) {
    throw UsageError(
        "--start-heading-variance, --start-position-variance: only for --mode vehicle");
  }
  if (tracker.mode == Mode::kHandheld &&
      (!options.suspension.empty() || options.tilt_sigma_rad || options.tilt_time_constant_s)) {
    throw UsageError("--suspension, --tilt-sigma, --tilt-time-constant: only for --mode vehicle");
  }
  if (tracker.mode == Mode::kVehicle) {
    set_start(options, first, tracker);
    tracker.tilt = tilt_of(options, source, tracker.filter);
  }
  tracker.travel_sigma_rad = travel_sigma_of(options, tracker);
  return tracker;
}

}  // namespace cairn::host
