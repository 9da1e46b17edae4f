#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: what a camera sees, and heights.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::check_camera(
    const FixedCamera& camera, const FixedMount& T_vehicle_camera, FixedPixel sigma_px) const {
  if (!initialised_) return Status::kNotInitialised;
  if (sigma_px.raw() <= 0) return Status::kInvalidArgument;
  const Status status = T_vehicle_camera.check();
  return ok(status) ? camera.check_numbers() : status;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::update_pixels(
    const FixedCamera& camera, const FixedMount& T_vehicle_camera, FixedPixel sigma_px,
    FixedPixelMatch* matches, int count, FixedUpdateReport& report) {
  if constexpr (LandmarkDim != 3) {
    static_cast<void>(camera), static_cast<void>(T_vehicle_camera), static_cast<void>(sigma_px);
    static_cast<void>(matches), static_cast<void>(count), static_cast<void>(report);
    return Status::kInvalidArgument;
  } else {
    return detail::FixedPixelUpdate<FixedPlanarSlam>(*this, camera, T_vehicle_camera, sigma_px,
                                                     matches, count, report)
        .run_with_all();
  }
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::update_pixels(
    const FixedCamera& camera, const FixedMount& T_vehicle_camera, FixedPixel sigma_px,
    FixedPixelMatch* matches, int count, Random& random, FixedUpdateReport& report) {
  if constexpr (LandmarkDim != 3) {
    static_cast<void>(random);
    return update_pixels(camera, T_vehicle_camera, sigma_px, matches, count, report);
  } else {
    return detail::FixedPixelUpdate<FixedPlanarSlam>(*this, camera, T_vehicle_camera, sigma_px,
                                                     matches, count, report)
        .run(random);
  }
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::predict_pixel(
    int slot, const FixedCamera& camera, const FixedMount& T_vehicle_camera, FixedPixel sigma_px,
    FixedPixelPrediction& prediction) {
  if constexpr (LandmarkDim != 3) {
    static_cast<void>(slot), static_cast<void>(camera), static_cast<void>(T_vehicle_camera);
    static_cast<void>(sigma_px), static_cast<void>(prediction);
    return Status::kInvalidArgument;
  } else {
    const Status status = check_camera(camera, T_vehicle_camera, sigma_px);
    if (!ok(status)) return status;
    if (slot < 0 || slot >= landmark_count()) return Status::kNotFound;
    absorb_motion();
    const PixelModel model(state_, errors_,
                           state_.camera_view(camera, T_vehicle_camera, saturations_), sigma_px);
    FixedPixelPrediction expected;
    if (!model.expect(slot, expected, errors_.scratch(), saturations_) ||
        !camera.contains(expected.pixel)) {
      return Status::kOutOfView;
    }
    prediction = expected;
    return Status::kOk;
  }
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::expect_pixel(
    int slot, const FixedCamera& camera, const FixedMount& T_vehicle_camera, FixedPixel sigma_px,
    FixedPixelPrediction& prediction) const {
  if constexpr (LandmarkDim != 3 || kWorld) {
    static_cast<void>(slot), static_cast<void>(camera), static_cast<void>(T_vehicle_camera);
    static_cast<void>(sigma_px), static_cast<void>(prediction);
    return Status::kInvalidArgument;
  } else {
    const Status status = check_camera(camera, T_vehicle_camera, sigma_px);
    if (!ok(status)) return status;
    if (slot < 0 || slot >= landmark_count()) return Status::kNotFound;
    std::int32_t scratch[2 * kStates];
    std::uint32_t none = 0;
    const PixelModel model(state_, errors_, state_.camera_view(camera, T_vehicle_camera, none),
                           sigma_px);
    FixedPixelPrediction expected;
    if (!model.expect(slot, expected, scratch, none) || !camera.contains(expected.pixel)) {
      return Status::kOutOfView;
    }
    prediction = expected;
    return Status::kOk;
  }
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::plan_pixels(
    const FixedCamera& camera, const FixedMount& T_vehicle_camera, FixedPixel sigma_px,
    FixedVector<FixedPlannedPixel, MaxLandmarks>& plan) {
  if constexpr (LandmarkDim != 3) {
    static_cast<void>(camera), static_cast<void>(T_vehicle_camera), static_cast<void>(sigma_px);
    static_cast<void>(plan);
    return Status::kInvalidArgument;
  } else {
    constexpr FixedPixel kMargin = FixedPixel::nearest(2.0);
    const Status status = check_camera(camera, T_vehicle_camera, sigma_px);
    if (!ok(status)) return status;
    plan.clear();
    absorb_motion();
    const PixelModel model(state_, errors_,
                           state_.camera_view(camera, T_vehicle_camera, saturations_), sigma_px);
    for (int slot = 0; slot < landmark_count(); ++slot) {
      FixedPlannedPixel entry;
      FixedPixelPrediction& p = entry.prediction;
      if (!model.expect(slot, p, errors_.scratch(), saturations_) ||
          !camera.contains(p.pixel, kMargin)) {
        continue;
      }
      using Priority = decltype(entry.priority);
      entry.priority = subtract(multiply<Priority>(p.xx, p.yy, saturations_),
                                multiply<Priority>(p.xy, p.xy, saturations_), saturations_);
      plan.push_back(entry);
      for (int i = plan.size() - 1; i > 0 && plan[i - 1].priority < plan[i].priority; --i) {
        const FixedPlannedPixel moved = plan[i];
        plan[i] = plan[i - 1];
        plan[i - 1] = moved;
      }
    }
    return Status::kOk;
  }
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
    constexpr int kFiner = detail::kPixelBits - FixedLength::kFractionBits;
    if (!initialised_) return Status::kNotInitialised;
    if (sigma.raw() <= 0 || gate.raw() <= 0) return Status::kInvalidArgument;
    const int slot = find(id);
    if (slot < 0) return Status::kNotFound;
    detail::FixedPixelSighting& seen = pixels_[0];
    seen = detail::FixedPixelSighting();
    seen.slot = slot;
    seen.rows = 1;
    seen.h[0][2] = FixedTangent::nearest(1.0);
    std::uint32_t lost = 0;
    const FixedLength missed =
        subtract(height, convert<FixedLength>(landmark_height(slot), lost), lost);
    seen.innovation[0] = missed.raw() * (std::int64_t{1} << kFiner);
    seen.sigma[0] = sigma.raw() * (std::int64_t{1} << kFiner);
    if (height_score(seen, sigma, lost) > gate.raw()) return Status::kGated;
    saturations_ += lost;
    FixedUpdateReport report;
    apply(pixels_, 1, report);
    return Status::kOk;
  }
}

/// Squared Mahalanobis distance, with the fraction of a FixedScore.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
std::int64_t FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::height_score(
    const detail::FixedPixelSighting& seen, FixedLength sigma, std::uint32_t& lost) {
  constexpr int kScoreBits = 20;
  const auto noise = multiply<FixedVariance>(convert<Fixed<std::int64_t, 24>>(sigma, lost),
                                             Fixed<std::int64_t, 20>::from_raw(sigma.raw()), lost);
  const FixedRoot root = square_root(add(landmark_height_variance(seen.slot), noise, lost).raw(),
                                     FixedVariance::kFractionBits);
  std::uint32_t none = 0;  // a distance too large for its format is large
  const std::int64_t y =
      wide::narrow(wide::divide(seen.innovation[0], root.mantissa,
                                kScoreBits + root.bits - detail::kPixelBits, none),
                   none);
  return wide::round_shift(y * y, 2 * kScoreBits - FixedScore::kFractionBits);
}

}  // namespace cairn
