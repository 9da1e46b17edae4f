#include "host_sim/run/input_log_file.hpp"

#include <cstdlib>
#include <memory>
#include <vector>

#include <fmt/format.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted_iekf_slam.hpp"
#include "cairn/runtime/replay.hpp"

#include "host_sim/io/input_error.hpp"
#include "host_sim/run/core_conversions.hpp"
#include "host_sim/run/instruction_count.hpp"
#include "host_sim/run/scene_objects.hpp"

namespace cairn::host {
namespace {

LogFilter to_log_filter(const std::string& name) {
  if (name == "mono") return LogFilter::kMono;
  if (name == "ekf") return LogFilter::kEkf;
  if (name == "lifted-iekf") return LogFilter::kLiftedIekf;
  return LogFilter::kGroupIekf;
}

struct FileBytes {
  std::ifstream stream;
  int read(std::uint8_t* bytes, int count) {
    stream.read(reinterpret_cast<char*>(bytes), count);
    return static_cast<int>(stream.gcount());
  }
};

class LogReplay {
 public:
  explicit LogReplay(const std::filesystem::path& path)
      : path_(path), bytes_{std::ifstream(path, std::ios::binary)}, reader_(bytes_) {
    if (!bytes_.stream) throw InputError(path, "cannot be read: expected an input log");
    check(reader_.open(header_));
  }

  void run(const ReplayOptions& options) {
    marked_ = options.marked;
    std::string config = options.config;
    const PinholeCamera<float>& camera = header_.camera;
    if (config.empty()) {
      const bool fits = camera.width <= DefaultConfig::kMaxImageWidth &&
                        camera.height <= DefaultConfig::kMaxImageHeight;
      config = fits ? "default" : "large";
    }
    if (config == "tiny") return run_with<TinyConfig>();
    if (config == "large") return run_with<LargeConfig>();
    run_with<DefaultConfig>();
  }

 private:
  template <class Config>
  void run_with() {
    constexpr int kMax = Config::kMaxLandmarks;
    if (header_.mode == LogMode::kHandheld) return run_tracker<HandheldTracker<Config>>();
    switch (header_.filter) {
      case LogFilter::kEkf:
        return run_tracker<VehicleTracker<Config, EkfSlam<float, kMax, 3>>>();
      case LogFilter::kLiftedIekf:
        return run_tracker<VehicleTracker<Config, LiftedIekfSlam<float, kMax, 3>>>();
      case LogFilter::kGroupIekf:
      case LogFilter::kMono:
        break;
    }
    run_tracker<VehicleTracker<Config, GroupIekfSlam<float, kMax, 3>>>();
  }

  template <class Tracker>
  void run_tracker() {
    const auto tracker = std::make_unique<Tracker>();
    check(start_replay(header_, *tracker));
    const int width = header_.camera.width;
    const int height = header_.camera.height;
    std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) *
                                     static_cast<std::size_t>(height));
    const MutableImageView image{pixels.data(), width, height, width};
    SceneObjects objects(kVehicleObjectHeight);
    std::vector<OdometrySample> odometry;
    LogEvent event = LogEvent::kOdometry;
    OdometrySample sample;
    LogFrame frame;
    for (;;) {
      check(reader_.next(event, sample, frame, image));
      if (event == LogEvent::kEnd) return;
      if (event == LogEvent::kOdometry) {
        odometry.push_back(sample);
        continue;
      }
      FrameReport report;
      if (marked_) cairn_mark_frame_begin();
      for (const OdometrySample& each : odometry) {
        // A sample that is refused is in the tracker's counters, and so in the hash.
        static_cast<void>(replay_odometry(each, *tracker));
      }
      odometry.clear();
      const TickSource ticks = marked_ ? marking_ticks() : TickSource{};
      replay_work_limit(frame, *tracker);
      report.status = tracker->process_frame(image, frame.t_us, ticks, report);
      if (marked_) {
        objects.draw(*tracker, image, ticks, report);
        cairn_mark_frame_end();
      }
      fmt::print("frame {} {} {} {:016x}\n", frame.number, frame.t_us, to_string(report.status),
                 frame_hash(*tracker, report));
    }
  }

  void check(Status status) const {
    if (ok(status)) return;
    throw InputError(path_, fmt::format("{}: expected a whole input log of version {}",
                                        to_string(status), kInputLogVersion));
  }

  std::filesystem::path path_;
  FileBytes bytes_;
  InputLogReader<FileBytes> reader_;
  InputLogHeader header_;
  bool marked_ = false;
};

}  // namespace

InputLogHeader to_log_header(const TrackerOptions& options, const SourceInfo& source,
                             std::int64_t start_us) {
  InputLogHeader header;
  header.mode = options.mode == Mode::kVehicle ? LogMode::kVehicle : LogMode::kHandheld;
  header.filter = to_log_filter(options.filter);
  const MonoParameters<float> mono;
  header.fading = mono.fading_factor;
  header.adaptive_fading = mono.fading == FadingMode::kAdaptive;
  if (options.fading == "adaptive") {
    header.adaptive_fading = true;
  } else if (!options.fading.empty()) {
    header.fading = std::strtof(options.fading.c_str(), nullptr);
    header.adaptive_fading = false;
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
  return header;
}

bool RecordingSource::Sink::write(const std::uint8_t* bytes, int count) {
  stream.write(reinterpret_cast<const char*>(bytes), count);
  return static_cast<bool>(stream);
}

RecordingSource::RecordingSource(FrameSource& source, std::filesystem::path path,
                                 const InputLogHeader& header, const Frame& first,
                                 std::optional<int> work_limit)
    : source_(source),
      path_(std::move(path)),
      work_limit_(work_limit.value_or(LogFrame::kOwnWorkLimit)),
      sink_{std::ofstream(path_, std::ios::binary)},
      writer_(sink_) {
  check(writer_.begin(header));
  record(first);
}

bool RecordingSource::next(Frame& frame) {
  if (source_.next(frame)) {
    record(frame);
    return true;
  }
  check(writer_.end());
  sink_.stream.flush();
  if (!sink_.stream) check(Status::kFull);
  return false;
}

void RecordingSource::record(const Frame& frame) {
  for (const OdometrySample& sample : frame.odometry) check(writer_.odometry(sample));
  check(writer_.frame({static_cast<std::uint32_t>(frame.number), frame.t_us, work_limit_},
                      to_view(frame.grey)));
}

void RecordingSource::check(Status status) const {
  if (ok(status)) return;
  throw InputError(path_, status == Status::kFull
                              ? "the log cannot be written"
                              : fmt::format("the run cannot be recorded: {}", to_string(status)));
}

void replay_log(const std::filesystem::path& path, const ReplayOptions& options) {
  LogReplay(path).run(options);
}

}  // namespace cairn::host
