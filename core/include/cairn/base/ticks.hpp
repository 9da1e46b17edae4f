#pragma once

#include <cstdint>

namespace cairn {

/// Stages of one frame: the rows of paper A's Table 1.
enum class Stage : std::uint8_t {
  kPreprocess,      ///< image preprocessing
  kPosePrediction,  ///< camera pose estimation: the filter's prediction of pose and windows
  kFeatures,        ///< feature extraction and matching
  kPoseUpdate,      ///< camera pose calculation: RANSAC, filter update, map
  kRender,          ///< rendering and registration
};
inline constexpr int kStageCount = 5;

/// Tick counter handed in by the caller: the core has no clock. `read` may wrap at 2^32. A null
/// `read` turns measuring off; ticks never decide what is computed.
struct TickSource {
  std::uint32_t (*read)(void* context) = nullptr;
  void* context = nullptr;

  std::uint32_t now() const { return read != nullptr ? read(context) : 0U; }
};

/// Units of work (WorkBudget) that fit into the ticks left until a deadline: what a board hands to
/// FrameTracker::set_work_limit(). `ticks_per_unit`: the board's own, measured by a replay; 0 gives
/// no work.
constexpr int work_limit_for(std::uint32_t ticks_left, std::uint32_t ticks_per_unit) {
  constexpr std::uint32_t kMost = 1000000;
  if (ticks_per_unit == 0) return 0;
  const std::uint32_t units = ticks_left / ticks_per_unit;
  return static_cast<int>(units < kMost ? units : kMost);
}

}  // namespace cairn
