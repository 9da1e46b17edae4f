#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "cairn/base/ticks.hpp"

namespace cairn::host {

/// Instructions of one frame on this machine. The stages' do not add up to the total: the steps
/// between them are no stage's. Odometry counts as pose prediction.
struct FrameInstructions {
  double total = 0.0;
  std::array<double, kStageCount> stages{};
};

struct InstructionCounts {
  std::vector<FrameInstructions> frames;  ///< of the whole log, or none
  std::string problem;                    ///< why there are none
};

/// Replays the input log in cairn_count_frames, which lies beside this program, under valgrind's
/// callgrind: the same numbers in every run. None where valgrind is missing or cannot run it.
/// Writes into `folder` while it counts.
InstructionCounts count_instructions(const std::filesystem::path& log,
                                     const std::filesystem::path& folder);

}  // namespace cairn::host
