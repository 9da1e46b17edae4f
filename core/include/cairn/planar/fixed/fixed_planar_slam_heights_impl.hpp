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

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::predict_tilt(FixedOffset dt_s) {
  constexpr int kBits = 44;
  constexpr int kNoiseBits = 40;
  if (!initialised_) return Status::kNotInitialised;
  if (dt_s.raw() < 0) return Status::kInvalidArgument;
  if (!tilts() || rest_.hold_time(dt_s)) return Status::kOk;
  const FixedTiltParameters& p = parameters_.tilt;
  std::uint32_t none = 0;  // ages and more than ages leave nothing
  const std::int64_t decay =
      exp_negative_44(wide::divide(dt_s.raw(), p.time_constant.raw(), kBits, none));
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
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::add_landmark(
    LandmarkId id, const FixedLength (&y)[3], const FixedCovariance3& noise, LandmarkId* replaced) {
  if constexpr (LandmarkDim == 2) {
    static_cast<void>(id), static_cast<void>(y), static_cast<void>(noise);
    static_cast<void>(replaced);
    return Status::kInvalidArgument;
  } else {
    constexpr int kBits = detail::FixedCholesky3::kBits;
    if (!initialised_) return Status::kNotInitialised;
    const detail::FixedAxes axes(heading_);
    detail::FixedRotation rotation = detail::rotation_about_vertical(axes.cosine, axes.sine);
    if (tilts()) rotation = rotation * detail::rotation_of(tilt_);
    detail::FixedCholesky3 own;
    std::uint32_t none = 0;
    const FixedCovariance3 of_world = detail::turned(noise, rotation, none);
    if (!detail::cholesky(noise, own, none) || !detail::cholesky(of_world, own, none)) {
      return Status::kInvalidArgument;
    }
    const Status status = make_room(id, replaced);
    if (!ok(status)) return status;
    // What rested may tilt by now.
    end_rest();
    if (slots_.size() == 0) {
      share_pose_error();
    } else {
      absorb_motion();
    }
    if (tilts()) {
      rotation =
          detail::rotation_about_vertical(axes.cosine, axes.sine) * detail::rotation_of(tilt_);
    }
    (void)detail::cholesky(detail::turned(noise, rotation, none), own, saturations_);
    FixedLength seen[3];
    rotation.turn(y, seen, saturations_);
    const int slot = slots_.size();
    order_[slot] = static_cast<std::int16_t>(slot);
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = convert<FixedCoordinate>(seen[axis], saturations_);
      p_[slot][axis] = axis < 2 ? add(x_[axis], at, saturations_) : at;
    }
    // Errors: the vehicle's own, the tilt's turn about its axes, and the noise.
    const detail::FixedCameraView level({}, {}, axes.cosine, axes.sine, tilts() ? &tilt_ : nullptr,
                                        saturations_);
    const int first = state_of(slot);
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3;
      const int last = (axis + 2) % 3;
      FixedLength by_tilt[2];
      for (int k = 0; k < 2; ++k) {
        by_tilt[k] = subtract(multiply<FixedLength>(seen[last], level.axes[k][next], saturations_),
                              multiply<FixedLength>(seen[next], level.axes[k][last], saturations_),
                              saturations_);
      }
      const auto element = [&](int column) {
        std::int64_t sum = column >= first && column - first <= axis ? own.at(axis, column - first)
                                                                     : std::int64_t{0};
        const auto enter = [&](int state, std::int64_t factor, int fraction) {
          if (column > state) return;
          const std::int64_t part = wide::scale(factor * factor_.at(state, column),
                                                kBits - fraction - factor_.bits(state), none);
          sum = wide::add(sum, part, none);
        };
        if (axis < 2) enter(1 + axis, 1, 0);
        for (int k = 0; tilts() && k < 2; ++k) {
          enter(kTiltState + k, by_tilt[k].raw(), FixedLength::kFractionBits);
        }
        return sum;
      };
      factor_.append(kBits, element, saturations_, 2);
    }
    slots_.push(id, updates_);
    ++health_.landmarks_added;
    return Status::kOk;
  }
}

}  // namespace cairn
