#pragma once

#include <cstdint>

namespace cairn {

/// Stages of one frame: the rows of paper A's Table 1.
enum class Stage : std::uint8_t {
  kPreprocess,      ///< image preprocessing
  kPosePrediction,  ///< camera pose estimation: the filter's prediction of pose and windows
  kFeatures,        ///< feature extraction and matching
  kPoseUpdate,      ///< camera pose calculation: RANSAC, filter update, six-degree pose, map
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

}  // namespace cairn
