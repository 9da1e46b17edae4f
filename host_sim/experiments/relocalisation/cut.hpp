#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// Trials of the hand-held tracker on a recorded video with reference poses.
struct CutSettings {
  int trials = 24;  ///< of each kind and length, their starts spread evenly
  std::vector<int> lengths = {60};
  std::uint64_t seed = 1;
  int first_start = 150;  ///< frames before the first trial: the map must have begun
  int watched = 90;       ///< frames after the picture is back
};

struct CutTrial {
  bool black = false;  ///< the picture was black; otherwise the frames are left out of the video
  int length = 0;
  int start = 0;
  int library = 0;              ///< landmarks that could tell the place
  bool said_lost = false;       ///< at some frame
  int frames_to_recovery = -1;  ///< from the picture's return to lasting tracking; -1: never
  bool tracking = false;        ///< at the end
  double error_m = 0.0;         ///< position at the end, the frames before the cut aligned (Sim(3))
  double undisturbed_error_m = 0.0;  ///< the same of the tracker that saw every frame
};

/// Tracks all of `source` with the hand-held tracker, and beside it, from every trial's frame on, a
/// copy that misses pictures. Deterministic in source and settings. `progress` gets trials done and
/// their number.
std::vector<CutTrial> run_cut_trials(FrameSource& source, const CutSettings& settings,
                                     const std::function<void(int, int)>& progress);

}  // namespace cairn::host
