#pragma once

#include "cairn/planar/fixed/covariance3.hpp"
#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: landmarks with height, and the tilt of the vehicle's body.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedCoordinate FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::landmark_height(int slot) const {
  if constexpr (LandmarkDim == 3) return p_[slot][2];
  static_cast<void>(slot);
  return {};
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedVariance FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::landmark_height_variance(
    int slot) const {
  if (LandmarkDim == 2) return {};
  return factor_covariance(state_of(slot) + 2, state_of(slot) + 2);
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedCovariance2 FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::tilt_covariance() const {
  if (!tilts()) return {};
  return {factor_covariance(kTiltState, kTiltState), factor_covariance(kTiltState + 1, kTiltState),
          factor_covariance(kTiltState + 1, kTiltState + 1)};
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::start_tilt() {
  const FixedTiltParameters& p = parameters_.tilt;
  keep_tilt({multiply<FixedVariance>(p.sigma_pitch, p.sigma_pitch, saturations_), FixedVariance(),
             multiply<FixedVariance>(p.sigma_roll, p.sigma_roll, saturations_)});
}

/// Appends the tilt's states with this covariance to the pose's.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::keep_tilt(const FixedCovariance2& tilt) {
  // A third state of variance 1 beside it, for the sake of the function.
  const FixedCovariance3 three = {tilt.xx, tilt.xy, tilt.yy, {}, {}, FixedVariance::nearest(1.0)};
  detail::FixedCholesky3 factor;
  (void)detail::cholesky(three, factor, saturations_);
  for (int row = 0; row < 2; ++row) {
    const auto element = [&](int column) {
      return column < kTiltState ? std::int64_t{0} : factor.at(row, column - kTiltState);
    };
    factor_.append(detail::FixedCholesky3::kBits, element, saturations_);
  }
}

/// Share of a tilt that is left, 44 fraction bits.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
std::int64_t FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::tilt_decay(FixedOffset dt_s) const {
  constexpr int kBits = 44;
  std::uint32_t none = 0;  // ages and more than ages leave nothing
  return exp_negative_44(
      wide::divide(dt_s.raw(), parameters_.tilt.time_constant.raw(), kBits, none));
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedCovariance2 FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::tilt_noise(
    FixedOffset dt_s) const {
  std::uint32_t none = 0;
  const FixedVariance decay = FixedVariance::from_raw(tilt_decay(dt_s));
  constexpr FixedVariance kOne = FixedVariance::nearest(1.0);
  const FixedVariance share = subtract(kOne, multiply<FixedVariance>(decay, decay, none), none);
  const auto noise = [&](FixedAngle sigma) {
    const auto variance = multiply<FixedVariance>(sigma, sigma, none);
    return multiply<FixedVariance>(share, variance, none);
  };
  return {noise(parameters_.tilt.sigma_pitch), {}, noise(parameters_.tilt.sigma_roll)};
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::predict_tilt(FixedOffset dt_s) {
  constexpr int kBits = 44;
  constexpr int kNoiseBits = 40;
  if (!initialised_) return Status::kNotInitialised;
  if (dt_s.raw() < 0) return Status::kInvalidArgument;
  if (!tilts() || rest_.hold_time(dt_s)) return Status::kOk;
  const FixedTiltParameters& p = parameters_.tilt;
  const std::int64_t decay = tilt_decay(dt_s);
  const auto left = FixedRatio::from_raw(
      static_cast<std::int32_t>(wide::round_shift(decay, kBits - FixedRatio::kFractionBits)));
  const FixedRoot added = square_root(
      (std::int64_t{1} << kBits) - wide::multiply(decay, decay, kBits, saturations_), kBits);
  tilt_ = {multiply<FixedAngle>(tilt_.pitch, left, saturations_),
           multiply<FixedAngle>(tilt_.roll, left, saturations_)};
  const int n = factor_.size();
  for (int k = 0; k < 2; ++k) {
    const int row = kTiltState + k;
    factor_.shrink_row(row, left);
    const FixedAngle sigma = k == 0 ? p.sigma_pitch : p.sigma_roll;
    const std::int64_t noise =
        wide::scale(std::int64_t{sigma.raw()} * added.mantissa,
                    kNoiseBits - FixedAngle::kFractionBits - added.bits, saturations_);
    const int length = wide::bit_length(static_cast<std::uint64_t>(noise));
    if (!factor_.make_room(row, 2 * (length - kNoiseBits), saturations_)) continue;
    for (int i = 0; i < n; ++i) scratch_[i] = 0;
    scratch_[row] = factor_.to_row(row, noise, kNoiseBits);
    factor_.absorb(scratch_, row);
  }
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::update_height(LandmarkId id,
                                                                        FixedLength height,
                                                                        FixedLength sigma,
                                                                        FixedScore gate) {
  if constexpr (LandmarkDim != 3) {
    static_cast<void>(id), static_cast<void>(height), static_cast<void>(sigma);
    static_cast<void>(gate);
    return Status::kInvalidArgument;
  } else {
    constexpr int kScoreBits = 20;
    constexpr int kFiner = detail::kPixelBits - FixedLength::kFractionBits;
    if (!initialised_) return Status::kNotInitialised;
    if (sigma.raw() <= 0 || gate.raw() <= 0) return Status::kInvalidArgument;
    PixelSighting& seen = pixels_[0];
    const int slot = find(id);
    if (slot < 0) return Status::kNotFound;
    seen = PixelSighting();
    seen.slot = slot;
    seen.rows = 1;
    seen.h[0][2] = FixedTangent::nearest(1.0);
    const FixedLength missed =
        subtract(height, convert<FixedLength>(landmark_height(slot), saturations_), saturations_);
    seen.innovation[0] = missed.raw() * (std::int64_t{1} << kFiner);
    seen.sigma[0] = sigma.raw() * (std::int64_t{1} << kFiner);
    const auto noise =
        multiply<FixedVariance>(convert<Fixed<std::int64_t, 24>>(sigma, saturations_),
                                Fixed<std::int64_t, 20>::from_raw(sigma.raw()), saturations_);
    const FixedRoot root =
        square_root(add(landmark_height_variance(slot), noise, saturations_).raw(),
                    FixedVariance::kFractionBits);
    std::uint32_t none = 0;  // a distance too large for its format is large
    const std::int64_t y =
        wide::narrow(wide::divide(seen.innovation[0], root.mantissa,
                                  kScoreBits + root.bits - detail::kPixelBits, none),
                     none);
    if (wide::round_shift(y * y, 2 * kScoreBits - FixedScore::kFractionBits) > gate.raw()) {
      return Status::kGated;
    }
    FixedUpdateReport report;
    apply(pixels_, 1, report);
    return Status::kOk;
  }
}

}  // namespace cairn
