#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/base/shard.hpp"
#include "host_sim/sources/playback_source.hpp"

namespace cairn::host {

/// How often hand-held tracking succeeds: windows of a recording, times seeds, times ways to play
/// them. Counted are a window's frames as they are played, after the first 30 (15 where there are
/// fewer than 60).
struct RobustnessSettings {
  int window_frames = 200;        ///< of the recording, before playback leaves some out
  int step_frames = 50;           ///< from the start of a window to that of the next
  int seeds = 1;                  ///< 1 to so many
  std::string filter = "window";  ///< or mono
  std::vector<Playback> playbacks = {Playback{}};
  double least_tracked = 0.95;    ///< share of the frames
  double max_ate_m = 0.05;        ///< root mean square after Sim(3) alignment
  double max_rotation_deg = 3.5;  ///< root mean square after the best rotation
  int threads = 0;                ///< 0: all; never changes the result
  Shard shard;
};

/// One window tracked once.
struct WindowResult {
  int number = 0;  ///< among the windows of all shards, from 0
  Playback playback;
  int first_frame = 0;  ///< lowest number of the window's frames
  int frames = 0;       ///< as played
  std::uint64_t seed = 0;
  double tracked = 0.0;                   ///< share in state tracking or uncertain
  double sure = 0.0;                      ///< share in state tracking
  std::optional<double> ate_m;            ///< none with fewer than 10 tracked frames of known pose
  std::optional<double> rotation_deg;     ///< as ate_m
  std::optional<double> attitude_inside;  ///< share of NEES within 3 sigma, of frames that have one
  std::uint32_t losses = 0;               ///< of the whole window
  bool success = false;  ///< tracked enough and, where the truth is known, both errors in limits
  bool silent = false;   ///< no success although enough frames say tracking
};

/// The windows of one source, sorted by playback, first frame and seed.
struct RobustnessResult {
  std::string source;
  bool truth = false;  ///< some frame's true pose is known; otherwise success is tracking alone
  int windows_of_all_shards = 0;
  std::vector<WindowResult> windows;
};

/// Tracks every window of `frames`, which `info` describes. `progress(done, total)` is called
/// under a lock. Throws InputError where there are fewer frames than one window, or the tracker
/// refuses the camera.
RobustnessResult measure_robustness(
    const std::string& name, const SourceInfo& info, const std::vector<Frame>& frames,
    const RobustnessSettings& settings,
    const std::function<void(int done, int total)>& progress = nullptr);

}  // namespace cairn::host
