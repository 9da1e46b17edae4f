#pragma once

#include "cairn/planar/fixed/pixel_sighting.hpp"

namespace cairn::detail {

/// What a camera sees of a FixedPlanarState's landmarks, at its mean as it is.
template <class State, class Errors>
class FixedPixelModel {
 public:
  FixedPixelModel(const State& state, const Errors& errors, const FixedCameraView& view,
                  FixedPixel sigma_px)
      : state_(state), errors_(errors), view_(view), sigma_px_(sigma_px) {}

  /// The sighting of a landmark, without its innovation. Whether it has a pixel. `scratch`: kStates
  /// elements.
  bool sight(int slot, FixedPixelSighting& out, FixedPixelRows& rows, std::int32_t* scratch,
             std::uint32_t& saturations) const;
  /// The pixel with the covariance of its innovation. `scratch`: 2 kStates elements.
  bool expect(int slot, FixedPixelPrediction& prediction, std::int32_t* scratch,
              std::uint32_t& saturations) const;

 private:
  const State& state_;
  const Errors& errors_;
  FixedCameraView view_;
  FixedPixel sigma_px_;
};

template <class State, class Errors>
bool FixedPixelModel<State, Errors>::sight(int slot, FixedPixelSighting& out, FixedPixelRows& rows,
                                           std::int32_t* scratch,
                                           std::uint32_t& saturations) const {
  constexpr int kBits = FixedVariance::kFractionBits;
  const FixedLength r[3] = {state_.relative(slot, 0), state_.relative(slot, 1),
                            convert<FixedLength>(state_.height(slot), saturations)};
  if (!view_.linearise(r, rows, saturations)) return false;
  out.slot = slot;
  out.rows = 2;
  // The noise grows with the relative variance of the depth: sigma sqrt(1 + Var z / z^2).
  const std::int64_t variance =
      errors_.depth_variance(state_, slot, rows.depth, scratch, saturations);
  const std::int64_t depth_m = rows.p_camera[2].raw();
  const std::int64_t share =
      wide::divide(variance, depth_m * depth_m, 2 * FixedLength::kFractionBits, saturations);
  const FixedRoot factor =
      square_root(wide::add(std::int64_t{1} << kBits, share, saturations), kBits);
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 3; ++k) out.h[i][k] = rows.h[i][k];
    for (int k = 0; k < 2; ++k) out.tilt[i][k] = rows.tilt[i][k];
    const std::int64_t sigma =
        wide::multiply(sigma_px_.raw(), rows.per_pixel[i], FixedPixel::kFractionBits, saturations);
    out.sigma[i] = wide::multiply(sigma, factor.mantissa, factor.bits, saturations);
    if (out.sigma[i] == 0) out.sigma[i] = 1;
    out.per_pixel[i] = rows.per_pixel[i];
  }
  return true;
}

template <class State, class Errors>
bool FixedPixelModel<State, Errors>::expect(int slot, FixedPixelPrediction& prediction,
                                            std::int32_t* scratch,
                                            std::uint32_t& saturations) const {
  FixedPixelSighting sighting;
  FixedPixelRows rows;
  if (!sight(slot, sighting, rows, scratch, saturations)) return false;
  const FixedCovariance2 own =
      errors_.innovation_covariance(state_, sighting, scratch, saturations);
  // From m^2 to px^2.
  const auto variance = [&](FixedVariance s, int i, int j) {
    const std::int64_t once = wide::divide(s.raw(), rows.per_pixel[i], kPixelBits, saturations);
    constexpr int kShift =
        FixedPixelVariance::kFractionBits + kPixelBits - FixedVariance::kFractionBits;
    return FixedPixelVariance::from_raw(wide::divide(once, rows.per_pixel[j], kShift, saturations));
  };
  prediction.id = state_.slots().id(slot);
  prediction.slot = slot;
  for (int i = 0; i < 2; ++i) prediction.pixel[i] = rows.pixel[i];
  for (int i = 0; i < 3; ++i) prediction.p_camera[i] = rows.p_camera[i];
  prediction.xx = variance(add(own.xx, sighting.noise(0, saturations), saturations), 0, 0);
  prediction.xy = variance(own.xy, 0, 1);
  prediction.yy = variance(add(own.yy, sighting.noise(1, saturations), saturations), 1, 1);
  return true;
}

}  // namespace cairn::detail
