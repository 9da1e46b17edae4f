#pragma once

#include "cairn/planar/fixed/camera.hpp"

namespace cairn::detail {

/// Up to two rows of one landmark, in metres.
struct FixedPixelSighting {
  int slot = -1;
  int source = -1;
  int rows = 2;
  FixedTangent h[2][3];
  FixedLength tilt[2][2];
  std::int64_t innovation[2];  ///< kPixelBits
  std::int64_t sigma[2];
  std::int64_t per_pixel[2];  ///< see FixedPixelRows
  FixedCovariance2 own;       ///< of the innovations without their noise, before the update

  /// Of row i's noise, m^2.
  FixedVariance noise(int i, std::uint32_t& saturations) const {
    constexpr int kDown = 2 * kPixelBits - FixedVariance::kFractionBits;
    return FixedVariance::from_raw(wide::multiply(sigma[i], sigma[i], kDown, saturations));
  }
};

}  // namespace cairn::detail
