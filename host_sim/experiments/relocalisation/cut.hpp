#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/base/shard.hpp"
#include "host_sim/sources/frame_source.hpp"

namespace cairn::host {

/// What happens to the picture of a hand-held camera.
enum class CutKind : std::uint8_t {
  kCut,     ///< frames are left out of the video
  kBlack,   ///< the same frames are shown black
  kReturn,  ///< black pictures, then the video backwards from there: the camera went away and back
};
const char* to_string(CutKind kind);
inline constexpr CutKind kCutKinds[] = {CutKind::kBlack, CutKind::kCut, CutKind::kReturn};

/// Trials of a hand-held tracker on a recorded video with reference poses.
struct CutSettings {
  int trials = 24;  ///< of each kind and length, their starts spread evenly
  std::vector<int> lengths = {60};
  std::string filter = "window";  ///< or mono
  std::uint64_t seed = 1;
  int first_start = 150;  ///< frames before the first trial: the map must have begun
  int watched = 90;       ///< frames after the picture is back
};

struct CutTrial {
  int number = 0;  ///< among all trials, from 0
  CutKind kind = CutKind::kCut;
  int length = 0;
  int start = 0;
  int library = 0;         ///< landmarks that could tell the place
  bool said_lost = false;  ///< at some frame
  /// From the picture's return to the first that shows at least half of what some picture of the
  /// 200 before the cut showed, by the reference poses and the median depth of the map; -1: none
  /// did.
  int frames_to_seen = -1;
  int frames_to_recovery = -1;  ///< from the picture's return to lasting tracking; -1: never
  bool tracking = false;        ///< at the end
  /// Of the position, against the last pose before the cut, moved as the reference poses moved.
  double recovery_error_m = 0.0;     ///< where tracking lasts again
  double error_m = 0.0;              ///< at the end
  double undisturbed_error_m = 0.0;  ///< the same of the tracker that saw every frame
};

/// Tracks all of `source` with the hand-held tracker, and beside it, from every trial's frame on, a
/// copy that misses pictures. Only the trials of `shard`. Deterministic in source and settings.
/// `progress` gets trials done and their number.
std::vector<CutTrial> run_cut_trials(FrameSource& source, const CutSettings& settings,
                                     const Shard& shard,
                                     const std::function<void(int, int)>& progress);

}  // namespace cairn::host
