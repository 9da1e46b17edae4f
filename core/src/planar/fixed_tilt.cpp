#include "cairn/planar/fixed/tilt.hpp"

namespace cairn::detail {

namespace {
constexpr int kDecayBits = 44;

/// Share of a tilt that is left.
std::int64_t decay_over(const FixedTiltParameters& parameters, FixedOffset dt_s) {
  std::uint32_t none = 0;  // ages and more than ages leave nothing
  return exp_negative_44(
      wide::divide(dt_s.raw(), parameters.time_constant.raw(), kDecayBits, none));
}
}  // namespace

FixedTiltStep tilt_step(const FixedTiltParameters& parameters, FixedOffset dt_s,
                        std::uint32_t& saturations) {
  const std::int64_t decay = decay_over(parameters, dt_s);
  const FixedRoot added = square_root(
      (std::int64_t{1} << kDecayBits) - wide::multiply(decay, decay, kDecayBits, saturations),
      kDecayBits);
  FixedTiltStep step;
  step.left = FixedRatio::from_raw(
      static_cast<std::int32_t>(wide::round_shift(decay, kDecayBits - FixedRatio::kFractionBits)));
  for (int k = 0; k < 2; ++k) {
    const FixedAngle sigma = k == 0 ? parameters.sigma_pitch : parameters.sigma_roll;
    step.noise[k] = wide::scale(std::int64_t{sigma.raw()} * added.mantissa,
                                FixedTiltStep::kNoiseBits - FixedAngle::kFractionBits - added.bits,
                                saturations);
  }
  return step;
}

FixedCovariance2 tilt_noise(const FixedTiltParameters& parameters, FixedOffset dt_s) {
  std::uint32_t none = 0;
  static_assert(FixedVariance::kFractionBits == kDecayBits);
  const FixedVariance decay = FixedVariance::from_raw(decay_over(parameters, dt_s));
  constexpr FixedVariance kOne = FixedVariance::nearest(1.0);
  const FixedVariance share = subtract(kOne, multiply<FixedVariance>(decay, decay, none), none);
  const auto noise = [&](FixedAngle sigma) {
    const auto variance = multiply<FixedVariance>(sigma, sigma, none);
    return multiply<FixedVariance>(share, variance, none);
  };
  return {noise(parameters.sigma_pitch), {}, noise(parameters.sigma_roll)};
}

FixedCovariance2 usual_tilt(const FixedTiltParameters& parameters, std::uint32_t& saturations) {
  const auto variance = [&](FixedAngle sigma) {
    return multiply<FixedVariance>(sigma, sigma, saturations);
  };
  return {variance(parameters.sigma_pitch), FixedVariance(), variance(parameters.sigma_roll)};
}

}  // namespace cairn::detail
