#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "cairn/runtime/input_log.hpp"

#include "host_sim/io/output_file.hpp"
#include "host_sim/sources/frame_source.hpp"
#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// Header of the input log of a run with `options` on `source`, whose first frame is at `start_us`.
InputLogHeader to_log_header(const TrackerOptions& options, const SourceInfo& source,
                             std::int64_t start_us);

/// A source that writes what it hands on into an input log. Throws OutputError when the log
/// cannot be written.
class RecordingSource : public FrameSource {
 public:
  /// `first` was taken from `source` already. `work_limit`: of each frame, if not the tracker's
  /// own.
  RecordingSource(FrameSource& source, std::filesystem::path path, const InputLogHeader& header,
                  const Frame& first, std::optional<int> work_limit);

  const SourceInfo& info() const override { return source_.info(); }
  /// Completes the log after the last frame.
  bool next(Frame& frame) override;
  /// Completes the log now: it holds what was handed on. Without it nothing is left.
  void finish();

 private:
  struct Sink {
    OutputFile file;
    bool write(const std::uint8_t* bytes, int count);
  };

  void record(const Frame& frame);
  void check(Status status) const;

  FrameSource& source_;
  std::filesystem::path path_;
  std::int32_t work_limit_;
  Sink sink_;
  InputLogWriter<Sink> writer_;
  bool finished_ = false;
};

/// Replays an input log on the tracker that its header names and prints one line per frame: number,
/// time, status, hash. `config`: default, tiny, large, or empty: the smaller of default and large
/// that fits. Throws InputError, naming the file, for anything but a whole log.
void replay_log(const std::filesystem::path& path, const std::string& config);

}  // namespace cairn::host
