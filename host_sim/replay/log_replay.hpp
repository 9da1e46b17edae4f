#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include "cairn/base/config.hpp"
#include "cairn/runtime/replay.hpp"

#include "host_sim/replay/core_trackers.hpp"

/// Replay of an input log on the tracker that its header names. Core and standard library alone:
/// cairn_count_frames runs it under valgrind, which does not know every instruction that OpenCV and
/// its codecs use.
namespace cairn::host {

/// Bytes of a file for an InputLogReader; none where it cannot be read.
class LogFile {
 public:
  explicit LogFile(const char* path) : file_(std::fopen(path, "rb")) {}

  bool opened() const { return file_ != nullptr; }
  int read(std::uint8_t* bytes, int count) {
    return static_cast<int>(std::fread(bytes, 1, static_cast<std::size_t>(count), file_.get()));
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

/// A frame of a log, with the odometry and the gyroscope's samples since the frame before.
struct ReplayFrame {
  LogFrame log;
  MutableImageView image;  ///< may be drawn into once it was processed
  std::vector<OdometrySample> odometry;
  std::vector<AngularRateSample> gyro;
};

/// Whether the tracker of these capacities takes the camera's images.
template <class Config>
bool fits(const PinholeCamera<float>& camera) {
  return camera.width <= Config::kMaxImageWidth && camera.height <= Config::kMaxImageHeight;
}

/// Hands a frame of a log to a tracker.
template <class Tracker>
void process_frame(const ReplayFrame& frame, Tracker& tracker, const TickSource& ticks,
                   FrameReport& report) {
  // A sample that is refused is in the tracker's counters, and so in the hash.
  for (const AngularRateSample& sample : frame.gyro) {
    static_cast<void>(replay_angular_rate(sample, tracker));
  }
  for (const OdometrySample& sample : frame.odometry) {
    static_cast<void>(replay_odometry(sample, tracker));
  }
  replay_work_limit(frame.log, tracker);
  report.status = tracker.process_frame(frame.image, frame.log.t_us, ticks, report);
}

/// Calls `on_frame(frame, tracker)` for every frame of an opened log, in order, with a Tracker that
/// the header set up. The reader's status where the log is damaged, the tracker's where it refuses
/// the header.
template <class Tracker, class OnFrame>
Status replay_on(InputLogReader<LogFile>& reader, const InputLogHeader& header, OnFrame& on_frame) {
  const auto tracker = std::make_unique<Tracker>();
  const Status started = start_replay(header, *tracker);
  if (!ok(started)) return started;
  const int width = header.camera.width;
  const int height = header.camera.height;
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) *
                                   static_cast<std::size_t>(height));
  ReplayFrame frame;
  frame.image = {pixels.data(), width, height, width};
  LogEvent event = LogEvent::kOdometry;
  OdometrySample sample;
  for (;;) {
    const Status status = reader.next(event, sample, frame.log, frame.image);
    if (!ok(status)) return status;
    if (event == LogEvent::kEnd) return Status::kOk;
    if (event == LogEvent::kOdometry) {
      frame.odometry.push_back(sample);
      continue;
    }
    if (event == LogEvent::kAngularRate) {
      frame.gyro.push_back(reader.angular_rate());
      continue;
    }
    on_frame(frame, *tracker);
    frame.odometry.clear();
    frame.gyro.clear();
  }
}

/// replay_on() with the tracker of the header's mode and filter and the capacities of Config.
template <class Config, class OnFrame>
Status replay_frames(InputLogReader<LogFile>& reader, const InputLogHeader& header,
                     OnFrame& on_frame) {
  constexpr int kMax = Config::kMaxLandmarks;
  if (header.mode == LogMode::kHandheld && header.filter == LogFilter::kWindow) {
    return replay_on<WindowTracker<Config>>(reader, header, on_frame);
  }
  if (header.mode == LogMode::kHandheld) {
    return replay_on<HandheldTracker<Config>>(reader, header, on_frame);
  }
  switch (header.filter) {
    case LogFilter::kEkf:
      return replay_on<VehicleTracker<Config, EkfSlam<float, kMax, 3>>>(reader, header, on_frame);
    case LogFilter::kLiftedIekf:
      return replay_on<VehicleTracker<Config, LiftedIekfSlam<float, kMax, 3>>>(reader, header,
                                                                               on_frame);
    case LogFilter::kGroupIekfFixed:
      return replay_on<VehicleTracker<Config, FixedVehicleSlam<kMax>>>(reader, header, on_frame);
    case LogFilter::kGroupIekf:
    case LogFilter::kMono:
    case LogFilter::kWindow:
      break;
  }
  return replay_on<VehicleTracker<Config, GroupIekfSlam<float, kMax, 3>>>(reader, header, on_frame);
}

}  // namespace cairn::host
