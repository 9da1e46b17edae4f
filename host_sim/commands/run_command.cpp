#include "host_sim/commands/run_command.hpp"

#include <charconv>
#include <memory>

#include <fmt/format.h>

#include "host_sim/commands/option_checks.hpp"
#include "host_sim/commands/run_kinds.hpp"
#include "host_sim/commands/source_options.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/options/run_options.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/running/live_view.hpp"

namespace cairn::host {
namespace {

void add_handheld_options(CLI::App& command, HandheldOptions& options) {
  command
      .add_option("--measurement", options.measurement,
                  "Handheld: find landmarks by their patches or by FREAK at FAST corners")
      ->check(CLI::IsMember({"patch", "freak"}));
  command
      .add_option("--corner-score", options.corner_score,
                  "Handheld: least FAST score of a new landmark")
      ->check(CLI::Range(1, 255));
  command.add_option("--sigma-px", options.sigma_px, "Handheld: standard deviation of a pixel")
      ->check(above_zero());
  command
      .add_option("--focal-error", options.focal_error,
                  "Handheld: make the tracker's focal length wrong by this share")
      ->check(between(-0.3, 0.3));
  command.add_flag("--estimate-focal-length", options.estimate_focal_length,
                   "Handheld: the focal length is a state of the filter");
  command
      .add_option("--focal-sigma", options.focal_sigma,
                  "Handheld: how well the focal length is known, as a share; 0: exactly")
      ->check(between(0.0, 0.5));
  command
      .add_option("--row-time", options.row_time_s,
                  "Handheld: seconds from one row of the picture to the next (a rolling "
                  "shutter's); 0: all at once")
      ->check(between(-0.1, 0.1));
}

void add_options(CLI::App& command, RunOptions& options) {
  command.add_option("SOURCE", options.source, "Built-in world, data set or video")->required();
  command.add_option("--out", options.out, "Folder for the results")->required();
  command.add_flag("--force", options.force,
                   "Use a folder that holds files; an earlier run's are removed");
  command.add_option("--mode", options.mode, "How the camera moves")
      ->check(CLI::IsMember({"vehicle", "handheld"}));
  command.add_option("--filter", options.filter, "Filter")
      ->check(CLI::IsMember(
          {"group-iekf", "group-iekf-fixed", "lifted-iekf", "ekf", "ekf-fixed", "mono", "window"}));
  command.add_option("--fading", options.fading, "Fading factor S >= 1 of mono, or 'adaptive'");
  command.add_option("--budget-ms", options.budget_ms, "Time budget of a frame, ms")
      ->check(above_zero())
      ->capture_default_str();
  command.add_option("--seed", options.seed, "Seed of everything random")
      ->check(seed_number())
      ->capture_default_str();
  add_range_options(command, options);
  command
      .add_option("--work-limit", options.work_limit,
                  "Work of a frame, in units of 1000 instructions on a Cortex-M7")
      ->check(not_negative());
  command.add_option("--record", options.record,
                     "Also write the run's input log, for replay on host and board");
  command.add_option("--overlay", options.overlay, "How virtual objects are drawn into the video")
      ->check(CLI::IsMember({"wireframe", "shaded"}));
  command.add_flag("!--no-video", options.video, "Do not write the overlay video");
  command.add_flag("--scene-points", options.scene_points,
                   "Registration error of a video source with --truth: by points of the scene, "
                   "triangulated with it");
  command.add_flag("--view", options.view, "Show the run in a window; keys: space, s, q");
  command
      .add_option("--readout", options.hand_readout_ms,
                  "The built-in hand-held camera reads a picture out in so many ms")
      ->check(between(0.0, 100.0));
  command.add_option("--odometry-noise", options.odometry_noise, "Noise of the hall's odometry")
      ->check(CLI::IsMember({"s1", "base"}))
      ->capture_default_str();
  command
      .add_option("--suspension", options.suspension,
                  "Vehicle: how its body pitches and rolls; by default as the source says")
      ->check(CLI::IsMember({"flat", "car", "rover"}));
  command
      .add_option("--tilt-sigma", options.tilt_sigma_rad,
                  "Vehicle: standard deviation of pitch and roll, rad; 0: none")
      ->check(between(0.0, 0.3));
  command
      .add_option("--tilt-time-constant", options.tilt_time_constant_s,
                  "Vehicle: time in which pitch and roll return to 1/e, s")
      ->check(above_zero());
  command
      .add_option("--travel-sigma", options.travel_sigma_rad,
                  "Vehicle: standard deviation of the angle between its direction of travel and "
                  "where the camera's mount says, rad; 0: known exactly")
      ->check(between(0.0, 0.1));
  command
      .add_option("--uneven-floor", options.hall_tilt_rad,
                  "The hall's vehicle pitches and rolls by so much, rad rms")
      ->check(between(0.0, 0.1));
  command
      .add_option("--start-heading-variance", options.start_heading_variance,
                  "Variance of the start heading, rad^2; the start error is drawn from it")
      ->check(not_negative());
  command
      .add_option("--start-position-variance", options.start_position_variance,
                  "Variance of the start position, m^2; the start error is drawn from it")
      ->check(not_negative());
  command
      .add_option(
          "--profile", options.profile,
          "Landmark recordings: as recorded; with the noise that the data set states and no "
          "slip noise; or with the data set's measured calibration")
      ->check(CLI::IsMember({"plain", "stated", "calibrated"}))
      ->capture_default_str();
  add_handheld_options(command, options.handheld);
  command
      .add_option_function<std::string>(
          "--playback",
          [&options](const std::string& value) { options.playback.backward = value == "backward"; },
          "Handheld: play the frames in their order, or from the last to the first")
      ->check(CLI::IsMember({"forward", "backward"}));
  command.add_option("--every", options.playback.every, "Play each Nth frame")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  add_picture_options(command, options);
  add_odometry_options(command, options);
  add_gyro_options(command, options);
}

void check_fading(const std::string& fading) {
  if (fading.empty() || fading == "adaptive") return;
  double value = 0.0;
  const char* end = fading.data() + fading.size();
  const auto parsed = std::from_chars(fading.data(), end, value);
  if (parsed.ec != std::errc() || parsed.ptr != end || !(value >= 1.0 && value <= 2.0)) {
    throw UsageError(
        fmt::format("--fading '{}': expected 'adaptive' or a number in [1, 2]", fading));
  }
}

}  // namespace

void register_run_command(CommandContext& context) {
  CLI::App* command =
      context.app.add_subcommand("run", "Track a source and report every frame's latency");
  const auto options = std::make_shared<RunOptions>();
  add_options(*command, *options);
  command->callback([&context, command, options] {
    check_fading(options->fading);
    if (!options->record.empty() && !options->handheld.is_in_log()) {
      throw UsageError("--record: an input log replays the tracker's own settings");
    }
    if (!options->record.empty() && options->travel_sigma_rad) {
      throw UsageError("--travel-sigma: not with --record: an input log replays the tracker's own");
    }
    if (options->view) require_viewer();
    if (!options->force) refuse_full_folder(options->out);
    options->command_line = context.command_line;
    options->given = given_options(*command);
    context.exit_code = dispatch_run(*options);
  });
}

}  // namespace cairn::host
