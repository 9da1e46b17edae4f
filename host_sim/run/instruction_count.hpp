#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cairn/base/ticks.hpp"

extern "C" {
/// Bounds of a frame and of its stages, found by name by a profiler.
void cairn_mark_frame_begin();
void cairn_mark_stage();
void cairn_mark_frame_end();
}

namespace cairn::host {

/// A tick source that marks the stages and tells no time.
TickSource marking_ticks();

/// Instructions of one frame on this machine; of its stages where the tracker reported all of them.
struct FrameInstructions {
  double total = 0.0;
  std::optional<std::vector<double>> stages;  ///< kStageCount of them
};

/// Replays the input log under valgrind's callgrind and counts: the same numbers in every run.
/// Nothing when valgrind is not installed; `problem` then says so. Writes into `folder`.
std::vector<FrameInstructions> count_instructions(const std::filesystem::path& log,
                                                  const std::filesystem::path& folder,
                                                  std::string& problem);

}  // namespace cairn::host
