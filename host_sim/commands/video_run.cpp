#include "host_sim/commands/video_run.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "cairn/base/config.hpp"

#include "host_sim/commands/gyro_of_run.hpp"
#include "host_sim/commands/run_printing.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/interruption.hpp"
#include "host_sim/io/suspension.hpp"
#include "host_sim/reports/report.py.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/reports/run_outputs.hpp"
#include "host_sim/running/mount_run.hpp"
#include "host_sim/running/runner.hpp"
#include "host_sim/sources/cropped_source.hpp"
#include "host_sim/sources/data_sets.hpp"
#include "host_sim/sources/hall_source.hpp"
#include "host_sim/sources/hand_source.hpp"
#include "host_sim/sources/playback_source.hpp"
#include "host_sim/sources/scaled_source.hpp"
#include "host_sim/sources/stress_source.hpp"
#include "host_sim/sources/video_source.hpp"
#include "host_sim/timing/timing_run.hpp"
#include "host_sim/trackers/input_log_file.hpp"
#include "host_sim/world/gaussian.hpp"

namespace cairn::host {
namespace {

constexpr int kHallSmallFrames = 60;
constexpr int kRecordedAnchorFrames = 10;

/// A lens need be good in the part of the picture alone that is used.
LensCheck lens_check(const RunOptions& options) {
  return options.crop.empty() ? LensCheck::kWholePicture : LensCheck::kLater;
}

/// Whether pictures are drawn of the frames. A backward run keeps all its frames, so without
/// colour.
bool draws(const RunOptions& options) {
  const bool tracked = !options.timing && !options.check_mount && !options.use_source;
  return tracked && !options.playback.backward;
}

/// Whether a second decoding in colour is worth its time: the few pictures of a report are not.
bool in_colour(const RunOptions& options) {
  return draws(options) && (options.video || options.view);
}

FrameRange range_of(const RunOptions& options) {
  return {options.first_frame, options.max_frames, in_colour(options)};
}

/// The first of `names` that the command line gives.
std::string first_of(std::initializer_list<const char*> names,
                     const std::vector<std::string>& given) {
  for (const char* name : names) {
    if (std::find(given.begin(), given.end(), name) != given.end()) return name;
  }
  return {};
}

Mode mode_of(const RunOptions& options, const SourceInfo& source) {
  if (options.mode.empty()) return source.odometry.has_value() ? Mode::kVehicle : Mode::kHandheld;
  const Mode mode = options.mode == "vehicle" ? Mode::kVehicle : Mode::kHandheld;
  if (mode == Mode::kVehicle && !source.odometry.has_value()) {
    throw UsageError(fmt::format("--mode vehicle: source '{}' has no odometry", source.name));
  }
  return mode;
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
  return tracker;
}

RegistrationSettings registration_settings(const SourceInfo& source, Mode mode) {
  RegistrationSettings settings;
  const bool built_in = source.name == "hall" || source.name == "hall-small";
  if (!built_in) settings.anchor_frames = kRecordedAnchorFrames;
  if (mode == Mode::kHandheld) settings.map_scale.reset();
  return settings;
}

/// Every part, and whether it is suspect.
ExitCode check_mount(FrameSource& source, Frame& first, Tracker& tracker) {
  const MountRun run = run_for_mount(source, first, tracker);
  fmt::print("frames {}   tracked {}   with a suspicion {}\n", run.frames, run.tracked,
             run.suspect_frames);
  for (const MountOffset::Part part : kMountParts) {
    fmt::print("{:<28}{}\n", describe(run.offset, part),
               run.offset.suspect[part] ? "suspect" : "not contradicted");
  }
  print_suspicions(run.offset);
  print_suspicion(run.ground);
  print_suspicion(run.yaw);
  const bool suspect = run.offset.any_suspect() || run.ground->suspect() || run.yaw->suspect();
  return suspect ? ExitCode::kCheckFailed : ExitCode::kOk;
}

/// The source with pictures of the part and size asked for, and of one that the tracker holds.
std::unique_ptr<FrameSource> fit_source(std::unique_ptr<FrameSource> source,
                                        const RunOptions& options) {
  if (!options.crop.empty()) {
    source = crop_source(std::move(source), parse_crop(options.crop));
    check_lens(source->info().camera,
               options.camera.empty() ? std::filesystem::path(options.source) : options.camera);
  }
  const PinholeCamera<double> full = source->info().camera;
  const double fitting =
      fitting_factor(full, LargeConfig::kMaxImageWidth, LargeConfig::kMaxImageHeight);
  const double asked = options.scale.value_or(1.0);
  if (std::min(asked, fitting) == 1.0) return source;
  source = scale_source(std::move(source), std::min(asked, fitting));
  if (fitting < asked) {
    const PinholeCamera<double>& small = source->info().camera;
    fmt::print(stderr,
               "cairn_sim: pictures scaled from {}x{} to {}x{}, calibration too: the tracker holds "
               "{}x{}\n",
               full.width, full.height, small.width, small.height, LargeConfig::kMaxImageWidth,
               LargeConfig::kMaxImageHeight);
  }
  return source;
}

/// Says warnings that have come since the first `said`.
void say_warnings(const SourceInfo& info, std::size_t& said) {
  for (; said < info.warnings.size(); ++said) {
    fmt::print(stderr, "cairn_sim: warning: {}\n", info.warnings[said]);
  }
}

/// The whole source, given to options.use_source.
ExitCode use_source(FrameSource& source, const RunOptions& options) {
  std::size_t warnings_said = 0;
  options.use_source(source);
  say_warnings(source.info(), warnings_said);
  return source.info().damaged ? ExitCode::kInputInvalid : ExitCode::kOk;
}

ExitCode interrupted_code(const RunRecord& record) {
  fmt::print(stderr, "cairn_sim: interrupted after {} frames; the results are those of these\n",
             record.frames.size());
  return interrupted_by(record.interrupted_by);
}

ExitCode run_source(std::unique_ptr<FrameSource> opened, const RunOptions& options) {
  std::unique_ptr<FrameSource> fitting = with_gyro(fit_source(std::move(opened), options), options);
  if (options.use_source) return use_source(*fitting, options);
  if (options.playback.backward && mode_of(options, fitting->info()) == Mode::kVehicle) {
    throw UsageError("--playback backward: only for --mode handheld");
  }
  const std::unique_ptr<FrameSource> played = play_source(std::move(fitting), options.playback);
  FrameSource& source = *played;
  std::size_t warnings_said = 0;
  say_warnings(source.info(), warnings_said);
  Frame frame;
  if (!source.next(frame)) throw InputError(options.source, "expected at least one frame");
  const TrackerOptions tracker_settings = tracker_options(options, source.info(), frame);
  const std::unique_ptr<Tracker> tracker = make_tracker(tracker_settings, source.info());
  if (options.check_mount) return check_mount(source, frame, *tracker);
  make_folder(options.out);
  if (options.timing.has_value()) {
    return time_frames({source, frame, *tracker, tracker_settings, options});
  }

  remove_earlier_run(options.out);
  const InterruptionGuard guard;
  RunnerSettings runner;
  runner.out = options.out;
  runner.video = options.video;
  runner.shaded = options.overlay == "shaded";
  runner.view = options.view;
  runner.budget_ms = options.budget_ms;
  if (!options.record.empty() && !options.gyro.empty() && tracker_settings.mode == Mode::kVehicle) {
    throw UsageError("--record: an input log does not hold a vehicle's gyroscope");
  }
  std::optional<RecordingSource> recording;
  if (!options.record.empty()) {
    recording.emplace(source, options.record,
                      to_log_header(tracker_settings, source.info(), frame.t_us), frame,
                      tracker_settings.work_limit);
  }
  FrameSource& input = recording ? *recording : source;
  const RunRecord record = run_frames(input, frame, *tracker, runner);
  if (recording) recording->finish();
  const RegistrationResult registration =
      evaluate_registration(record.registration_input, source.info().camera,
                            registration_settings(source.info(), tracker_settings.mode));
  const RunTrajectory trajectory = evaluate_run(record, tracker_settings.mode);
  const nlohmann::json summary =
      summarise(record, trajectory, registration, options.budget_ms, source.info());

  write_manifest(options.out, {options.command_line, tracker_settings, options.source},
                 source.info(), record);
  write_frames(options.out, record, registration);
  write_trajectories(options.out, record, tracker_settings.mode);
  write_landmarks(options.out, record);
  write_uncertainty(options.out, record);
  write_health(options.out, record);
  write_json(options.out / "summary.json", summary);
  print_summary(summary);
  print_suspicions(record.mount);
  print_suspicion(record.ground);
  print_suspicion(record.yaw);
  print_gyro(record.gyro);
  if (record.mount_suspect_frame && !record.mount->any_suspect()) {
    fmt::print("calibration was suspect in {} frames, and is not at the end\n",
               record.health.mount_suspicions);
  }
  if (options.video && record.overlay.empty()) {
    fmt::print("overlay video not written: OpenCV has no encoder for H.264, MPEG-4 or MJPG\n");
  }
  if (const auto problem = draw_with_python("report.html", kReportScript, options.out)) {
    fmt::print("{}\n", *problem);
  } else {
    fmt::print("report: {}\n", (options.out / "report.html").string());
  }
  say_warnings(source.info(), warnings_said);
  if (record.ended_by_viewer) {
    fmt::print("ended in the window after {} frames; the results are those of these\n",
               record.frames.size());
  }
  if (record.interrupted_by != 0) return interrupted_code(record);
  return source.info().damaged ? ExitCode::kInputInvalid : ExitCode::kOk;
}

HallOptions hall_options(const RunOptions& options) {
  HallOptions hall;
  hall.seed = options.seed;
  hall.base_noise = options.odometry_noise == "base";
  hall.tilt_rad = options.hall_tilt_rad;
  hall.first_frame = options.first_frame.value_or(0);
  if (hall.first_frame < 0) throw UsageError("--first-frame: the hall's frames start at 0");
  hall.frame_count = options.max_frames;
  hall.colour = in_colour(options);
  return hall;
}

}  // namespace

ExitCode run_hall(const RunOptions& options, const std::string& /*argument*/) {
  return run_source(make_hall_source(hall_options(options)), options);
}

ExitCode run_hall_small(const RunOptions& options, const std::string& /*argument*/) {
  HallOptions hall = hall_options(options);
  hall.width = 320;
  hall.frame_count = options.max_frames.value_or(kHallSmallFrames);
  return run_source(make_hall_source(hall), options);
}

ExitCode run_hall_hand(const RunOptions& options, const std::string& /*argument*/) {
  HandOptions hand;
  hand.seed = options.seed;
  hand.first_frame = options.first_frame.value_or(0);
  if (hand.first_frame < 0) throw UsageError("--first-frame: the hall's frames start at 0");
  hand.frame_count = options.max_frames;
  hand.readout_s = 1e-3 * options.hand_readout_ms;
  return run_source(make_hand_source(hand), options);
}

ExitCode run_stress(const RunOptions& options, const std::string& fields) {
  StressScene scene = parse_stress_scene(fields);
  if (options.max_frames.has_value()) scene.frames = *options.max_frames;
  return run_source(make_stress_source(scene), options);
}

ExitCode run_seven_scenes(const RunOptions& options, const std::string& folder) {
  return run_source(make_seven_scenes_source(folder, range_of(options)), options);
}

ExitCode run_tag_board(const RunOptions& options, const std::string& folder) {
  return run_source(make_tag_board_source(folder, range_of(options)), options);
}

ExitCode run_kitti(const RunOptions& options, const std::string& folder) {
  if (is_kitti_raw(folder)) {
    return run_source(make_kitti_raw_source(folder, range_of(options)), options);
  }
  return run_source(make_kitti_source(folder, range_of(options), options.seed), options);
}

ExitCode run_tum_rgbd(const RunOptions& options, const std::string& folder) {
  return run_source(
      make_tum_rgbd_source(folder, options.camera, range_of(options), lens_check(options)),
      options);
}

ExitCode run_euroc(const RunOptions& options, const std::string& folder) {
  return run_source(
      make_euroc_source(folder, options.camera, range_of(options), lens_check(options)), options);
}

ExitCode run_camera(const RunOptions& options, const std::string& device) {
  VideoOptions camera;
  camera.media = device;
  camera.live = true;
  camera.camera = options.camera;
  camera.range = range_of(options);
  camera.hfov_deg = options.hfov_deg;
  camera.lens = lens_check(options);
  camera.colour = draws(options);
  return run_source(make_video_source(camera), options);
}

ExitCode run_video(const RunOptions& options, const std::string& media) {
  if (options.odometry.empty() && (options.speed_sigma_mps || options.yaw_rate_sigma_radps)) {
    throw UsageError("--odometry-noise-speed, --odometry-noise-yaw-rate: only with --odometry");
  }
  VideoOptions video;
  video.media = media;
  video.camera = options.camera;
  video.odometry = options.odometry;
  video.times = options.times;
  video.truth = options.truth;
  video.scene_points = options.scene_points;
  video.range = range_of(options);
  video.colour = draws(options);
  video.speed_sigma_mps = options.speed_sigma_mps;
  video.yaw_rate_sigma_radps = options.yaw_rate_sigma_radps;
  video.hfov_deg = options.hfov_deg;
  video.lens = lens_check(options);
  return run_source(make_video_source(video), options);
}

}  // namespace cairn::host
