#pragma once

#include "cairn/vision/detail/patch_rows.hpp"
#include "cairn/vision/patch.hpp"

namespace cairn {
namespace vision {

inline constexpr int kPaddedSide = kPatchSide + 2;    // one more on each side, for gradients
inline constexpr int kPaddedPitch = kPaddedSide + 1;  // whole pairs

}  // namespace vision

struct PatchTemplate::Moments {
  std::int32_t value = 0;
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int64_t value_x = 0;
  std::int64_t value_y = 0;
};

}  // namespace cairn
