#pragma once

#include "cairn/planar/fixed/types.hpp"

namespace cairn::detail {

/// What a time makes of the tilt: it keeps `left` of itself and gains independent noise.
struct FixedTiltStep {
  static constexpr int kNoiseBits = 40;
  FixedRatio left;
  std::int64_t noise[2] = {};  ///< deviations of pitch and roll, kNoiseBits fraction bits, rad
};
/// Domain: dt_s not negative, a body that tilts.
FixedTiltStep tilt_step(const FixedTiltParameters& parameters, FixedOffset dt_s,
                        std::uint32_t& saturations);
/// The variances of that noise.
FixedCovariance2 tilt_noise(const FixedTiltParameters& parameters, FixedOffset dt_s);
/// Of the tilt while nothing is known of it.
FixedCovariance2 usual_tilt(const FixedTiltParameters& parameters, std::uint32_t& saturations);

}  // namespace cairn::detail
