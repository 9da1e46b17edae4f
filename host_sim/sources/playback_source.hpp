#pragma once

#include <memory>
#include <vector>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// How recorded frames are played: every frame or each `every`th, in their order or from the last
/// to the first. A setting that fits one recording by chance seldom fits all of these.
struct Playback {
  bool backward = false;
  int every = 1;  ///< at least 1

  bool is_plain() const { return !backward && every == 1; }
};

/// The frames as `playback` shows them. Backwards, times are mirrored about the middle, so that
/// they increase and every step keeps its length; odometry is left out, and a gyroscope's rates
/// have the other sign. Forwards, a frame gets the odometry of the frames left out before it.
/// Pictures are shared, not copied.
std::vector<Frame> play(const std::vector<Frame>& frames, const Playback& playback);

/// Of pictures played so: backwards, the last row comes first.
ReadoutTimes played_readout(const ReadoutTimes& readout, const Playback& playback);

/// Every frame left in `source`, with pictures of its own.
std::vector<Frame> read_frames(FrameSource& source);

/// `frames` as a source, described by `info`, whose frame_count is completed.
std::unique_ptr<FrameSource> make_memory_source(SourceInfo info, std::vector<Frame> frames);

/// `source` as `playback` shows it. Backwards, all of its frames are read at once and kept in
/// memory. Errors: those of the source.
std::unique_ptr<FrameSource> play_source(std::unique_ptr<FrameSource> source,
                                         const Playback& playback);

}  // namespace cairn::host
