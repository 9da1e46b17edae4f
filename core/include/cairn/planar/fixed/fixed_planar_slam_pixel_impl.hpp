#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: what a camera sees.

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
typename FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::PixelView
FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::camera_view(const FixedCamera& camera,
                                                               const FixedMount& T_vehicle_camera,
                                                               std::uint32_t& saturations) const {
  const detail::FixedAxes axes(heading_);
  return PixelView(camera, T_vehicle_camera, axes.cosine, axes.sine, tilts() ? &tilt_ : nullptr,
                   saturations);
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
detail::FixedStateRow FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::row_of(
    const PixelSighting& sighting, int row) const {
  detail::FixedStateRow out;
  const int l = state_of(sighting.slot);
  for (int i = 0; i < 3; ++i) {
    const std::int64_t h = sighting.h[row][i].raw();
    if (h == 0) continue;
    out.add(l + i, h, FixedTangent::kFractionBits);
    if (i < 2) out.add(1 + i, -h, FixedTangent::kFractionBits);
  }
  for (int k = 0; tilts() && k < 2; ++k) {
    const std::int64_t t = sighting.tilt[row][k].raw();
    if (t != 0) out.add(kTiltState + k, t, FixedLength::kFractionBits);
  }
  return out;
}

/// The sighting of a landmark, its innovation minus the expected pixel. Whether it has one.
/// `scratch`: kStates elements.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
bool FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::sight(
    const PixelView& view, int slot, FixedPixel sigma_px, PixelSighting& out,
    detail::FixedPixelRows& rows, std::int32_t* scratch, std::uint32_t& saturations) const {
  constexpr int kBits = 44;
  const FixedLength r[3] = {relative(slot, 0), relative(slot, 1),
                            convert<FixedLength>(landmark_height(slot), saturations)};
  if (!view.linearise(r, rows, saturations)) return false;
  out.slot = slot;
  out.rows = 2;
  // The noise grows with the relative variance of the depth: sigma sqrt(1 + Var z / z^2).
  detail::FixedStateRow depth;
  const int l = state_of(slot);
  for (int i = 0; i < 3; ++i) {
    if (rows.depth[i].raw() == 0) continue;
    depth.add(l + i, rows.depth[i].raw(), FixedTangent::kFractionBits);
    if (i < 2) depth.add(1 + i, -rows.depth[i].raw(), FixedTangent::kFractionBits);
  }
  const int bits = factor_.product(depth, l + 2, RowScaledFactor<kStates>::kMostBits, scratch);
  std::int64_t squared = 0;
  for (int j = 0; j <= l + 2; ++j) squared += std::int64_t{scratch[j]} * scratch[j];
  const std::int64_t depth_m = rows.p_camera[2].raw();
  std::int64_t variance = wide::scale(squared, kBits - 2 * bits, saturations);
  if (!motion_.empty()) {
    const FixedCovariance2 waiting = waiting_noise(slot, saturations);
    variance =
        wide::add(variance, form(waiting, rows.depth, rows.depth, saturations).raw(), saturations);
  }
  const std::int64_t share =
      wide::divide(variance, depth_m * depth_m, 2 * FixedLength::kFractionBits, saturations);
  const FixedRoot factor =
      square_root(wide::add(std::int64_t{1} << kBits, share, saturations), kBits);
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 3; ++k) out.h[i][k] = rows.h[i][k];
    for (int k = 0; k < 2; ++k) out.tilt[i][k] = rows.tilt[i][k];
    const std::int64_t sigma =
        wide::multiply(sigma_px.raw(), rows.per_pixel[i], FixedPixel::kFractionBits, saturations);
    out.sigma[i] = wide::multiply(sigma, factor.mantissa, factor.bits, saturations);
    if (out.sigma[i] == 0) out.sigma[i] = 1;
    out.per_pixel[i] = rows.per_pixel[i];
  }
  return true;
}

/// Covariance of the two rows without their noise, m^2. `scratch`: 2 kStates elements.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedCovariance2 FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::innovation_of(
    const PixelSighting& sighting, std::int32_t* scratch, std::uint32_t& saturations) const {
  const int last = state_of(sighting.slot) + 2;
  std::int32_t* const a[2] = {scratch, scratch + kStates};
  int bits[2];
  for (int i = 0; i < 2; ++i) {
    bits[i] = factor_.product(row_of(sighting, i), last, RowScaledFactor<kStates>::kMostBits, a[i]);
  }
  std::int64_t sums[3] = {};
  for (int j = 0; j <= last; ++j) {
    sums[0] += std::int64_t{a[0][j]} * a[0][j];
    sums[1] += std::int64_t{a[0][j]} * a[1][j];
    sums[2] += std::int64_t{a[1][j]} * a[1][j];
  }
  const auto variance = [&](int k, int i, int j) {
    return FixedVariance::from_raw(
        wide::scale(sums[k], FixedVariance::kFractionBits - bits[i] - bits[j], saturations));
  };
  FixedCovariance2 out = {variance(0, 0, 0), variance(1, 0, 1), variance(2, 1, 1)};
  if (motion_.empty()) return out;
  const FixedCovariance2 waiting = waiting_noise(sighting.slot, saturations);
  const auto enter = [&](FixedVariance& to, int i, int j) {
    to = add(to, form(waiting, sighting.h[i], sighting.h[j], saturations), saturations);
  };
  enter(out.xx, 0, 0);
  enter(out.xy, 0, 1);
  enter(out.yy, 1, 1);
  return out;
}

/// What odometry that no update has taken in adds to the vector from vehicle to landmark, m^2.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedCovariance2 FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::waiting_noise(
    int slot, std::uint32_t& saturations) const {
  FixedCovariance2 out;
  motion_.add_relative(relative(slot, 0), relative(slot, 1), out, saturations);
  return out;
}

/// a C b^T of the rows' parts in the plane.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedVariance FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::form(const FixedCovariance2& c,
                                                                      const FixedTangent (&a)[3],
                                                                      const FixedTangent (&b)[3],
                                                                      std::uint32_t& saturations) {
  const auto on = [&](FixedVariance x, FixedVariance y) {
    return add(multiply<FixedVariance>(x, b[0], saturations),
               multiply<FixedVariance>(y, b[1], saturations), saturations);
  };
  return add(multiply<FixedVariance>(on(c.xx, c.xy), a[0], saturations),
             multiply<FixedVariance>(on(c.xy, c.yy), a[1], saturations), saturations);
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
    if (slot < 0 || slot >= slots_.size()) return Status::kNotFound;
    absorb_motion();
    FixedPixelPrediction expected;
    if (!expect(camera_view(camera, T_vehicle_camera, saturations_), slot, sigma_px, expected,
                scratch_, saturations_) ||
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
    if (slot < 0 || slot >= slots_.size()) return Status::kNotFound;
    std::int32_t scratch[2 * kStates];
    std::uint32_t none = 0;
    FixedPixelPrediction expected;
    if (!expect(camera_view(camera, T_vehicle_camera, none), slot, sigma_px, expected, scratch,
                none) ||
        !camera.contains(expected.pixel)) {
      return Status::kOutOfView;
    }
    prediction = expected;
    return Status::kOk;
  }
}

/// False where the landmark has no pixel.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
bool FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::expect(const PixelView& view, int slot,
                                                               FixedPixel sigma_px,
                                                               FixedPixelPrediction& prediction,
                                                               std::int32_t* scratch,
                                                               std::uint32_t& saturations) const {
  PixelSighting sighting;
  detail::FixedPixelRows rows;
  if (!sight(view, slot, sigma_px, sighting, rows, scratch, saturations)) return false;
  const FixedCovariance2 own = innovation_of(sighting, scratch, saturations);
  // From m^2 to px^2.
  const auto variance = [&](FixedVariance s, int i, int j) {
    const std::int64_t once =
        wide::divide(s.raw(), rows.per_pixel[i], detail::kPixelBits, saturations);
    constexpr int kShift =
        FixedPixelVariance::kFractionBits + detail::kPixelBits - FixedVariance::kFractionBits;
    return FixedPixelVariance::from_raw(wide::divide(once, rows.per_pixel[j], kShift, saturations));
  };
  prediction.id = slots_.id(slot);
  prediction.slot = slot;
  for (int i = 0; i < 2; ++i) prediction.pixel[i] = rows.pixel[i];
  for (int i = 0; i < 3; ++i) prediction.p_camera[i] = rows.p_camera[i];
  prediction.xx = variance(add(own.xx, sighting.noise(0, saturations), saturations), 0, 0);
  prediction.xy = variance(own.xy, 0, 1);
  prediction.yy = variance(add(own.yy, sighting.noise(1, saturations), saturations), 1, 1);
  return true;
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
    const PixelView view = camera_view(camera, T_vehicle_camera, saturations_);
    for (int slot = 0; slot < slots_.size(); ++slot) {
      FixedPlannedPixel entry;
      FixedPixelPrediction& p = entry.prediction;
      if (!expect(view, slot, sigma_px, p, scratch_, saturations_) ||
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
std::int64_t FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::apply_row(
    const PixelSighting& sighting, int row) {
  const int last = state_of(sighting.slot) + LandmarkDim - 1;
  const int room = 29 - wide::bit_length(wide::magnitude(sighting.sigma[row])) + detail::kPixelBits;
  const detail::FixedStateRow h = row_of(sighting, row);
  const int most = RowScaledFactor<kStates>::kMostBits;
  const int bits = factor_.product(h, last, room < most ? room : most, scratch_);
  auto sigma = static_cast<std::int32_t>(
      wide::scale(sighting.sigma[row], bits - detail::kPixelBits, saturations_));
  if (sigma == 0) sigma = 1;
  // The innovation at the mean corrected so far.
  std::int64_t innovation = sighting.innovation[row];
  for (int k = 0; k < h.count; ++k) {
    const bool angle = h.state[k] >= kTiltState && h.state[k] < vehicle_states();
    const int fraction =
        h.bits[k] + (angle ? FixedAngle::kFractionBits : FixedOffset::kFractionBits);
    innovation = wide::add(innovation,
                           -wide::round_shift(h.coefficient[k] * correction_[h.state[k]],
                                              fraction - detail::kPixelBits),
                           saturations_);
  }
  return take_in(last, bits, sigma, innovation, detail::kPixelBits);
}

}  // namespace cairn
