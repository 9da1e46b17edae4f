#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

struct HandOptions {
  std::optional<int> frame_count;  ///< default 600
  int first_frame = 0;
  std::uint64_t seed = 1;
  double readout_s = 0.0;  ///< of a picture, from its first row to its last; 0: a global shutter
};

/// The built-in hall filmed by hand at 30 Hz, 640x480, f = 500 px. With a readout time the camera
/// has a rolling shutter: each four rows are rendered from where the camera was when they were
/// exposed, the frame's time is that of the middle row, and SourceInfo::readout says so. True
/// poses, no odometry, no colour. Everything is a function of the seed.
std::unique_ptr<FrameSource> make_hand_source(const HandOptions& options);

}  // namespace cairn::host
