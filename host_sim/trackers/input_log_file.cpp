#include "host_sim/trackers/input_log_file.hpp"

#include <fmt/format.h>

#include "host_sim/base/core_conversions.hpp"
#include "host_sim/io/input_error.hpp"
#include "host_sim/replay/log_replay.hpp"
#include "host_sim/trackers/fading.hpp"
#include "host_sim/trackers/window_adapter.hpp"

namespace cairn::host {
namespace {

LogFilter to_log_filter(const std::string& name) {
  if (name == "mono") return LogFilter::kMono;
  if (name == kWindowFilter) return LogFilter::kWindow;
  if (name == "ekf") return LogFilter::kEkf;
  if (name == "lifted-iekf") return LogFilter::kLiftedIekf;
  if (name == "group-iekf-fixed") return LogFilter::kGroupIekfFixed;
  return LogFilter::kGroupIekf;
}

/// Prints a frame's line.
struct PrintFrame {
  template <class Tracker>
  void operator()(const ReplayFrame& frame, Tracker& tracker) const {
    FrameReport report;
    process_frame(frame, tracker, TickSource{}, report);
    fmt::print("frame {} {} {} {:016x}\n", frame.log.number, frame.log.t_us,
               to_string(report.status), frame_hash(tracker, report));
  }
};

Status replay(LogFile& file, const std::string& config) {
  InputLogReader<LogFile> reader(file);
  InputLogHeader header;
  const Status status = reader.open(header);
  if (!ok(status)) return status;
  PrintFrame print;
  if (config == "tiny") return replay_frames<TinyConfig>(reader, header, print);
  const bool large = config.empty() ? !fits<DefaultConfig>(header.camera) : config == "large";
  if (large) return replay_frames<LargeConfig>(reader, header, print);
  return replay_frames<DefaultConfig>(reader, header, print);
}

}  // namespace

InputLogHeader to_log_header(const TrackerOptions& options, const SourceInfo& source,
                             std::int64_t start_us) {
  InputLogHeader header;
  header.mode = options.mode == Mode::kVehicle ? LogMode::kVehicle : LogMode::kHandheld;
  header.filter = to_log_filter(options.filter);
  MonoParameters<float> mono;
  set_fading(options.fading, mono);
  header.fading = mono.fading_factor;
  header.adaptive_fading = mono.fading == FadingMode::kAdaptive;
  if (header.filter == LogFilter::kWindow) {
    header.focal_sigma_e4 = window_focal_sigma_e4(options.handheld, source);
    header.readout = window_readout(options.handheld, source);
  }
  if (source.gyro) {
    header.with_gyro = true;
    header.gyro = *source.gyro;
  }
  header.seed = options.seed;
  header.start_t_us = start_us;
  header.camera = to_float(source.camera);
  header.T_vehicle_camera = to_float(source.T_vehicle_camera);
  header.frame_rate_hz = static_cast<float>(source.frame_rate_hz);
  if (source.odometry) {
    header.odometry_kind = source.odometry->kind;
    header.speed_sigma_mps = static_cast<float>(source.odometry->speed_sigma_mps);
    header.turn_sigma = static_cast<float>(source.odometry->turn_sigma);
    header.wheelbase_m = static_cast<float>(source.odometry->wheelbase_m);
    header.odometry_period_s = static_cast<float>(source.odometry->period_s);
  }
  header.start_x_m = static_cast<float>(options.start_x_m);
  header.start_y_m = static_cast<float>(options.start_y_m);
  header.start_theta_rad = static_cast<float>(options.start_theta_rad);
  header.start_position_variance = static_cast<float>(options.start_position_variance);
  header.start_heading_variance = static_cast<float>(options.start_heading_variance);
  header.tilt.sigma_pitch_rad = static_cast<float>(options.tilt.sigma_pitch_rad);
  header.tilt.sigma_roll_rad = static_cast<float>(options.tilt.sigma_roll_rad);
  header.tilt.time_constant_s = static_cast<float>(options.tilt.time_constant_s);
  return header;
}

bool RecordingSource::Sink::write(const std::uint8_t* bytes, int count) {
  file.write({reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(count)});
  return true;
}

RecordingSource::RecordingSource(FrameSource& source, std::filesystem::path path,
                                 const InputLogHeader& header, const Frame& first,
                                 std::optional<int> work_limit)
    : source_(source),
      path_(std::move(path)),
      work_limit_(work_limit.value_or(LogFrame::kOwnWorkLimit)),
      sink_{OutputFile(path_)},
      writer_(sink_) {
  check(writer_.begin(header));
  record(first);
}

bool RecordingSource::next(Frame& frame) {
  if (source_.next(frame)) {
    record(frame);
    return true;
  }
  finish();
  return false;
}

void RecordingSource::finish() {
  if (finished_) return;
  finished_ = true;
  check(writer_.end());
  sink_.file.finish();
}

void RecordingSource::record(const Frame& frame) {
  for (const AngularRateSample& sample : frame.gyro) check(writer_.angular_rate(sample));
  for (const OdometrySample& sample : frame.odometry) check(writer_.odometry(sample));
  check(writer_.frame({static_cast<std::uint32_t>(frame.number), frame.t_us, work_limit_},
                      to_view(frame.grey)));
}

void RecordingSource::check(Status status) const {
  if (ok(status)) return;
  throw InputError(path_, fmt::format("the run cannot be recorded: {}", to_string(status)));
}

void replay_log(const std::filesystem::path& path, const std::string& config) {
  LogFile file(path.c_str());
  if (!file.opened()) throw InputError(path, "cannot be read: expected an input log");
  const Status status = replay(file, config);
  if (ok(status)) return;
  throw InputError(path, fmt::format("{}: expected a whole input log of version {}",
                                     to_string(status), kInputLogVersion));
}

}  // namespace cairn::host
