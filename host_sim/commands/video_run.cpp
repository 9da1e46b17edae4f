#include "host_sim/commands/video_run.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "cairn/base/config.hpp"

#include "host_sim/commands/gyro_of_run.hpp"
#include "host_sim/commands/run_printing.hpp"
#include "host_sim/commands/tracker_of_run.hpp"
#include "host_sim/io/camera_file.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/io/interruption.hpp"
#include "host_sim/reports/report.py.hpp"
#include "host_sim/reports/run_folder.hpp"
#include "host_sim/reports/run_outputs.hpp"
#include "host_sim/reports/run_summary.hpp"
#include "host_sim/reports/run_trajectory.hpp"
#include "host_sim/running/mount_run.hpp"
#include "host_sim/running/runner.hpp"
#include "host_sim/sources/cropped_source.hpp"
#include "host_sim/sources/playback_source.hpp"
#include "host_sim/sources/scaled_source.hpp"
#include "host_sim/timing/timing_run.hpp"
#include "host_sim/trackers/input_log_file.hpp"

namespace cairn::host {
namespace {

constexpr int kRecordedAnchorFrames = 10;

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

/// The files of a run, but for its report.
nlohmann::json write_results(const RunRecord& record, const RunIdentity& identity,
                             const SourceInfo& source, const std::filesystem::path& out) {
  const Mode mode = identity.options.mode;
  const RegistrationResult registration = evaluate_registration(
      record.registration_input, source.camera, registration_settings(source, mode));
  nlohmann::json summary = summarise(record, evaluate_run(record, mode), registration,
                                     identity.options.budget_ms, source);
  write_manifest(out, identity, source, record);
  write_frames(out, record, registration);
  write_trajectories(out, record, mode);
  write_landmarks(out, record);
  write_uncertainty(out, record);
  write_health(out, record);
  write_json(out / "summary.json", summary);
  return summary;
}

void print_results(const RunRecord& record, const nlohmann::json& summary) {
  print_summary(summary);
  print_suspicions(record.mount);
  print_suspicion(record.ground);
  print_suspicion(record.yaw);
  print_gyro(record.gyro);
  if (record.mount_suspect_frame && !record.mount->any_suspect()) {
    fmt::print("calibration was suspect in {} frames, and is not at the end\n",
               record.health.mount_suspicions);
  }
}

void draw_report(const std::filesystem::path& out) {
  if (const auto problem = draw_with_python("report.html", kReportScript, out)) {
    fmt::print("{}\n", *problem);
  } else {
    fmt::print("report: {}\n", (out / "report.html").string());
  }
}

/// Tracks the source, and logs what the tracker gets where the options ask for it.
RunRecord track(FrameSource& source, Frame& first, Tracker& tracker, const TrackerOptions& settings,
                const RunOptions& options) {
  RunnerSettings runner;
  runner.out = options.out;
  runner.video = options.video;
  runner.shaded = options.overlay == "shaded";
  runner.view = options.view;
  runner.budget_ms = options.budget_ms;
  if (options.record.empty()) return run_frames(source, first, tracker, runner);
  if (!options.gyro.empty() && settings.mode == Mode::kVehicle) {
    throw UsageError("--record: an input log does not hold a vehicle's gyroscope");
  }
  RecordingSource recording(source, options.record,
                            to_log_header(settings, source.info(), first.t_us), first,
                            settings.work_limit);
  RunRecord record = run_frames(recording, first, tracker, runner);
  recording.finish();
  return record;
}

}  // namespace

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
  const TrackerOptions settings = tracker_options(options, source.info(), frame);
  const std::unique_ptr<Tracker> tracker = make_tracker(settings, source.info());
  if (options.check_mount) return check_mount(source, frame, *tracker);
  make_folder(options.out);
  if (options.timing.has_value()) {
    return time_frames({source, frame, *tracker, settings, options});
  }

  remove_earlier_run(options.out);
  const InterruptionGuard guard;
  const RunRecord record = track(source, frame, *tracker, settings, options);
  const nlohmann::json summary = write_results(
      record, {options.command_line, settings, options.source}, source.info(), options.out);
  print_results(record, summary);
  if (options.video && record.overlay.empty()) {
    fmt::print("overlay video not written: OpenCV has no encoder for H.264, MPEG-4 or MJPG\n");
  }
  draw_report(options.out);
  say_warnings(source.info(), warnings_said);
  if (record.ended_by_viewer) {
    fmt::print("ended in the window after {} frames; the results are those of these\n",
               record.frames.size());
  }
  if (record.interrupted_by != 0) return interrupted_code(record);
  return source.info().damaged ? ExitCode::kInputInvalid : ExitCode::kOk;
}

}  // namespace cairn::host
