#pragma once

#include "cairn/planar/fixed/camera.hpp"

namespace cairn::detail {

/// a C b^T of two rows' parts in the plane.
inline FixedVariance form(const FixedCovariance2& c, const FixedTangent (&a)[3],
                          const FixedTangent (&b)[3], std::uint32_t& saturations) {
  const auto on = [&](FixedVariance x, FixedVariance y) {
    return add(multiply<FixedVariance>(x, b[0], saturations),
               multiply<FixedVariance>(y, b[1], saturations), saturations);
  };
  return add(multiply<FixedVariance>(on(c.xx, c.xy), a[0], saturations),
             multiply<FixedVariance>(on(c.xy, c.yy), a[1], saturations), saturations);
}

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
  /// What two pixels differ by.
  void difference(const FixedPixel (&seen)[2], const FixedPixel (&expected)[2],
                  std::int64_t (&out)[2], std::uint32_t& saturations) const {
    for (int i = 0; i < 2; ++i) {
      const std::int64_t missed = std::int64_t{seen[i].raw()} - expected[i].raw();
      out[i] = wide::multiply(missed, per_pixel[i], FixedPixel::kFractionBits, saturations);
    }
  }
};

}  // namespace cairn::detail
