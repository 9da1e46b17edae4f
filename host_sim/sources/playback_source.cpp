#include "host_sim/sources/playback_source.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace cairn::host {
namespace {

/// Samples of the frames as a mirrored time reads them: the camera turns the other way.
std::vector<AngularRateSample> mirrored_gyro(const std::vector<Frame>& frames) {
  std::vector<AngularRateSample> samples;
  const std::int64_t both_us = frames.front().t_us + frames.back().t_us;
  for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) {
    for (auto sample = frame->gyro.rbegin(); sample != frame->gyro.rend(); ++sample) {
      samples.push_back({both_us - sample->t_us, -sample->rate_radps});
    }
  }
  return samples;
}

class MemorySource final : public FrameSource {
 public:
  MemorySource(SourceInfo info, std::vector<Frame> frames)
      : info_(std::move(info)), frames_(std::move(frames)) {
    info_.frame_count = static_cast<int>(frames_.size());
  }

  const SourceInfo& info() const override { return info_; }

  bool next(Frame& frame) override {
    if (position_ == frames_.size()) return false;
    frame = frames_[position_++];
    return true;
  }

 private:
  SourceInfo info_;
  std::vector<Frame> frames_;
  std::size_t position_ = 0;
};

void describe(const Playback& playback, SourceInfo& info) {
  info.readout = played_readout(info.readout, playback);
  info.note += fmt::format("{}played {}, every {} frame(s)", info.note.empty() ? "" : "; ",
                           playback.backward ? "backward" : "forward", playback.every);
  info.frame_rate_hz /= playback.every;
  if (info.frame_count)
    info.frame_count = (*info.frame_count + playback.every - 1) / playback.every;
  if (playback.backward || playback.every > 1) info.lap_frames.reset();
}

/// Each `every`th frame of a source, in its order.
class ThinnedSource final : public FrameSource {
 public:
  ThinnedSource(std::unique_ptr<FrameSource> source, const Playback& playback)
      : source_(std::move(source)), every_(playback.every), info_(source_->info()) {
    describe(playback, info_);
  }

  const SourceInfo& info() const override { return info_; }

  bool next(Frame& frame) override {
    const bool more = find_next(frame);
    info_.warnings = source_->info().warnings;
    info_.damaged = source_->info().damaged;
    return more;
  }

 private:
  bool find_next(Frame& frame) {
    std::vector<OdometrySample> odometry;
    std::vector<AngularRateSample> gyro;
    const int skipped = begun_ ? every_ - 1 : 0;
    begun_ = true;
    for (int i = 0; i <= skipped; ++i) {
      if (!source_->next(frame)) return false;
      odometry.insert(odometry.end(), frame.odometry.begin(), frame.odometry.end());
      gyro.insert(gyro.end(), frame.gyro.begin(), frame.gyro.end());
    }
    frame.odometry = std::move(odometry);
    frame.gyro = std::move(gyro);
    return true;
  }

  std::unique_ptr<FrameSource> source_;
  int every_;
  SourceInfo info_;
  bool begun_ = false;
};

}  // namespace

std::vector<Frame> play(const std::vector<Frame>& frames, const Playback& playback) {
  std::vector<Frame> played;
  std::vector<OdometrySample> odometry;
  std::vector<AngularRateSample> gyro;
  const std::size_t count = frames.size();
  const std::vector<AngularRateSample> mirrored =
      playback.backward && count > 0 ? mirrored_gyro(frames) : std::vector<AngularRateSample>();
  std::size_t next = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const Frame& frame = frames[playback.backward ? count - 1 - i : i];
    odometry.insert(odometry.end(), frame.odometry.begin(), frame.odometry.end());
    if (!playback.backward) gyro.insert(gyro.end(), frame.gyro.begin(), frame.gyro.end());
    if (i % static_cast<std::size_t>(playback.every) != 0) continue;
    played.push_back(frame);
    played.back().odometry = std::exchange(odometry, {});
    played.back().gyro = std::exchange(gyro, {});
    if (!playback.backward) continue;
    played.back().odometry.clear();
    played.back().t_us = frames.front().t_us + (frames.back().t_us - frame.t_us);
    while (next < mirrored.size() && mirrored[next].t_us <= played.back().t_us) {
      played.back().gyro.push_back(mirrored[next++]);
    }
  }
  return played;
}

ReadoutTimes played_readout(const ReadoutTimes& readout, const Playback& playback) {
  if (!playback.backward) return readout;
  return {-readout.row_time_s, -readout.column_time_s};
}

std::vector<Frame> read_frames(FrameSource& source) {
  std::vector<Frame> frames;
  Frame frame;
  while (source.next(frame)) {
    frames.push_back(frame);
    frame.grey = cv::Mat();
  }
  return frames;
}

std::unique_ptr<FrameSource> make_memory_source(SourceInfo info, std::vector<Frame> frames) {
  return std::make_unique<MemorySource>(std::move(info), std::move(frames));
}

std::unique_ptr<FrameSource> play_source(std::unique_ptr<FrameSource> source,
                                         const Playback& playback) {
  if (playback.is_plain()) return source;
  if (!playback.backward) return std::make_unique<ThinnedSource>(std::move(source), playback);
  std::vector<Frame> frames = play(read_frames(*source), playback);
  SourceInfo info = source->info();
  describe(playback, info);
  return make_memory_source(std::move(info), std::move(frames));
}

}  // namespace cairn::host
