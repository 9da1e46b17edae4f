#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace cairn::host {

/// Instructions of one frame on this machine; of its stages where the tracker reported all of them.
struct FrameInstructions {
  double total = 0.0;
  std::optional<std::vector<double>> stages;  ///< kStageCount of them
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
