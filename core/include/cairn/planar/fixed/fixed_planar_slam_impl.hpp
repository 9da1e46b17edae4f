#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: start, prediction, map.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::initialise(
    const FixedPose& pose, const FixedPoseCovariance& covariance,
    const FixedPlanarParameters& parameters) {
  const FixedCovariance2& c = covariance.position;
  if (!detail::possible(c.xx, c.yy, c.xy) ||
      !detail::possible(c.xx, covariance.heading, covariance.x_heading) ||
      !detail::possible(c.yy, covariance.heading, covariance.y_heading)) {
    return Status::kInvalidArgument;
  }
  const FixedPlanarParameters& p = parameters;
  const bool sane = p.gate.raw() > 0 && p.reacquire_after >= 0 && p.reacquire_steps >= 0 &&
                    p.reacquire_steps <= 20 && p.reacquire_position.raw() >= 0 &&
                    p.reacquire_heading.raw() >= 0 && p.reacquire_landmark_after >= 1 &&
                    p.reacquire_landmark.raw() >= 0 && p.replace_after >= 0 &&
                    p.rest_sigmas.raw() >= 0 && p.tilt.valid() && p.ransac.valid() &&
                    p.ransac_threshold.raw() > 0 && p.rescue_gate.raw() > 0 &&
                    (LandmarkDim == 3 || !p.tilt.tilts());
  if (!sane) return Status::kBadConfig;
  parameters_ = parameters;
  health_ = Health{};
  saturations_ = 0;
  updates_ = 0;
  slots_.clear();
  reacquisition_.clear();
  rest_ = detail::FixedRest();
  heading_ = wrapped_angle(pose.heading.raw());
  anchor_[0] = pose.x;
  anchor_[1] = pose.y;
  for (auto& x : x_) x = FixedCoordinate();
  factor_.clear();
  for (int i = 0; i < kPoseStates; ++i) factor_.append();
  tilt_ = FixedTilt();
  if (tilts()) start_tilt();
  motion_.clear();
  shared_ = FixedPoseCovariance();
  for (auto& coordinate : moved_) coordinate = FixedCoordinate();
  if (kWorld) {
    motion_.start(covariance);
  } else {
    shared_ = covariance;
  }
  initialised_ = true;
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::predict(const FixedIncrement& increment) {
  if (!initialised_) return Status::kNotInitialised;
  const Status status = detail::validate(increment);
  if (!ok(status)) return status;
  if (!rest_.hold(increment)) {
    end_rest();
    propagate(increment);
  }
  if (reacquisition_.take()) {
    end_rest();
    const int doublings = reacquisition_.steps() - 1;
    const auto widened = [&](auto sigma) {
      const auto fine = convert<Fixed<std::int64_t, 28>>(sigma, saturations_);
      const auto variance = multiply<FixedVariance>(fine, fine, saturations_);
      return FixedVariance::from_raw(wide::scale(variance.raw(), 2 * doublings, saturations_));
    };
    motion_.widen(widened(parameters_.reacquire_position), widened(parameters_.reacquire_heading),
                  saturations_);
    ++health_.reacquisitions;
  }
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::propagate(const FixedIncrement& increment) {
  const detail::FixedStep step = detail::fixed_step(increment, heading_, saturations_);
  motion_.move(increment, step, saturations_);
  x_[0] = add(x_[0], step.x, saturations_);
  x_[1] = add(x_[1], step.y, saturations_);
  if (kWorld) {
    moved_[0] = add(moved_[0], step.x, saturations_);
    moved_[1] = add(moved_[1], step.y, saturations_);
  }
  // Beyond the reach of a lever arm: counted here, where it is left.
  for (const FixedCoordinate x : x_) (void)convert<FixedLength>(x, saturations_);
  heading_ = wrapped_angle(std::int64_t{heading_.raw()} + increment.turn.raw());
}

/// The vehicle may have moved, or there is something to learn without motion.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::end_rest() {
  if (!rest_.resting()) return;
  const FixedIncrement held = rest_.held();
  const bool noise = rest_.holds_noise();
  const FixedOffset held_s = rest_.held_s();
  rest_.clear();
  if (noise) propagate(held);
  if (held_s.raw() > 0) (void)predict_tilt(held_s);
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::widen_pose(FixedVariance position,
                                                                     FixedVariance heading) {
  if (!initialised_) return Status::kNotInitialised;
  if (position.raw() < 0 || heading.raw() < 0) return Status::kInvalidArgument;
  end_rest();
  motion_.widen(position, heading, saturations_);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::slip_laterally(FixedVariance variance) {
  if (!initialised_) return Status::kNotInitialised;
  if (variance.raw() < 0) return Status::kInvalidArgument;
  if (variance.raw() == 0) return Status::kOk;
  end_rest();
  motion_.slip_laterally(variance, heading_, saturations_);
  return Status::kOk;
}

/// The world's error: that of the position turns with the heading's over the way since the last
/// time.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::turn_with_heading() {
  if (moved_[0].raw() == 0 && moved_[1].raw() == 0) return;
  const FixedLength by[2] = {-convert<FixedLength>(moved_[1], saturations_),
                             convert<FixedLength>(moved_[0], saturations_)};
  shear(1, by);
  for (FixedCoordinate& moved : moved_) moved = FixedCoordinate();
}

/// Adds the noise of the odometry to the factor: -J p (heading) on every point p of the group's
/// error, and the rest on the vehicle's position.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::absorb_motion() {
  if (kWorld) turn_with_heading();
  if (motion_.empty()) return;
  using Columns = typename detail::FixedMotionNoise::Columns;
  const Columns c = motion_.columns(saturations_);
  motion_.clear();
  const auto turned = [&](FixedLength by) {  // heading x coordinate, Columns::kBits
    if (kWorld) return std::int64_t{0};
    const std::int64_t product = std::int64_t{c.heading.mantissa} * by.raw();
    return wide::scale(product, Columns::kBits - c.heading.bits - FixedLength::kFractionBits,
                       saturations_);
  };
  std::int32_t* const v = scratch_;
  const auto enter = [&](int row, std::int64_t value, std::uint64_t more, int fraction) {
    const int length = wide::bit_length(wide::magnitude(value) | more);
    const bool room = factor_.make_room(row, 2 * (length + 1 - fraction), saturations_);
    v[row] = room ? factor_.to_row(row, value, fraction) : 0;
    return room;
  };
  enter(0, c.heading.mantissa, 0, c.heading.bits);
  const std::int64_t along[2] = {wide::add(c.along[0], turned(vehicle(1)), saturations_),
                                 wide::add(c.along[1], -turned(vehicle(0)), saturations_)};
  bool room[2];
  for (int i = 0; i < 2; ++i) {
    room[i] = enter(1 + i, along[i], wide::magnitude(c.rest[0][i]) | wide::magnitude(c.rest[1][i]),
                    Columns::kBits);
  }
  for (int row = kPoseStates; row < vehicle_states(); ++row) enter(row, 0, 0, Columns::kBits);
  for (int slot = 0; slot < slots_.size(); ++slot) {
    const int row = state_of(slot);
    enter(row, turned(landmark_local(slot, 1)), 0, Columns::kBits);
    enter(row + 1, -turned(landmark_local(slot, 0)), 0, Columns::kBits);
    if constexpr (LandmarkDim == 3) enter(row + 2, 0, 0, Columns::kBits);
  }
  factor_.absorb(v, 0);
  const int n = factor_.size();
  for (int k = 0; k < 2; ++k) {
    for (int i = 0; i < n; ++i) v[i] = 0;
    for (int axis = 0; axis < 2; ++axis) {
      if (room[axis]) v[1 + axis] = factor_.to_row(1 + axis, c.rest[k][axis], Columns::kBits);
    }
    factor_.absorb(v, 1);
  }
}

/// The error that pose and landmarks have in common by now: no sighting depends on it.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::share_pose_error() {
  shared_ = error_covariance(saturations_);
  const FixedCovariance2 tilt = tilt_covariance();
  factor_.clear();
  for (int i = 0; i < kPoseStates; ++i) factor_.append();
  if (tilts()) keep_tilt(tilt);
  motion_.clear();
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::make_room(LandmarkId id,
                                                                    LandmarkId* replaced) {
  if (id == kNoLandmark) return Status::kInvalidArgument;
  if (find(id) >= 0) return Status::kDuplicate;
  if (replaced != nullptr) *replaced = kNoLandmark;
  if (!slots_.full()) return Status::kOk;
  const int slot =
      parameters_.replace_after > 0
          ? slots_.replaceable(updates_, static_cast<std::uint32_t>(parameters_.replace_after))
          : -1;
  if (slot < 0) {
    ++health_.landmarks_refused;
    return Status::kFull;
  }
  if (replaced != nullptr) *replaced = slots_.id(slot);
  remove_states(slot);
  ++health_.landmarks_replaced;
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::remove_states(int slot) {
  const std::int16_t place = order_[slot];
  factor_.template remove_rows<LandmarkDim>(state_of(slot), scratch_);
  const int last = slots_.size() - 1;
  order_[slot] = order_[last];
  for (int axis = 0; axis < LandmarkDim; ++axis) p_[slot][axis] = p_[last][axis];
  for (int k = 0; k < last; ++k) {
    if (order_[k] > place) --order_[k];
  }
  slots_.remove_unordered(slot);
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::remove_landmark(int slot) {
  if (!initialised_) return Status::kNotInitialised;
  if (slot < 0 || slot >= slots_.size()) return Status::kNotFound;
  remove_states(slot);
  ++health_.landmarks_removed;
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::add_landmark(
    LandmarkId id, FixedLength x, FixedLength y, const FixedCovariance2& noise,
    LandmarkId* replaced) {
  if (!initialised_) return Status::kNotInitialised;
  if (LandmarkDim != 2) return Status::kInvalidArgument;
  FixedPointObservation seen;
  seen.x = x;
  seen.y = y;
  seen.noise = noise;
  const Status valid = detail::check(seen);
  if (!ok(valid)) return valid;
  const Status status = make_room(id, replaced);
  if (!ok(status)) return status;
  end_rest();
  if (slots_.size() == 0 && !kWorld) {
    share_pose_error();
  } else {
    absorb_motion();
  }
  const detail::FixedAxes axes(heading_);
  detail::FixedSighting sighting;
  (void)linearise(seen, axes, FixedLength(), FixedLength(), FixedLength(), sighting, saturations_);
  FixedLength world[2];
  axes.turn(x, y, world[0], world[1], saturations_);

  const int slot = slots_.size();
  for (int axis = 0; axis < 2; ++axis) {
    p_[slot][axis] =
        add(x_[axis], convert<FixedCoordinate>(world[axis], saturations_), saturations_);
  }
  order_[slot] = static_cast<std::int16_t>(slot);
  // Its error: the vehicle's own, and the noise along and across a direction, the two columns
  // turned so that they are triangular.
  constexpr int kNoiseBits = FixedOffset::kFractionBits - 1;
  const auto part = [](FixedRatio direction, FixedOffset sigma) {
    const std::int64_t product = std::int64_t{direction.raw()} * sigma.raw();
    return static_cast<std::int32_t>(wide::round_shift(product, FixedRatio::kFractionBits + 1));
  };
  std::int32_t first[2] = {part(sighting.cosine, sighting.sigma[0]),
                           part(sighting.sine, sighting.sigma[0])};
  std::int32_t second[2] = {part(-sighting.sine, sighting.sigma[1]),
                            part(sighting.cosine, sighting.sigma[1])};
  rotate(rotation_onto(first[0], second[0]), first, second, 2);
  append_row(1, first[0], 0, kNoiseBits);
  append_row(2, first[1], second[1], kNoiseBits);
  slots_.push(id, updates_);
  ++health_.landmarks_added;
  return Status::kOk;
}

/// Appends a state with the error of state `from` and noise of its own on the last two columns of
/// the landmark's.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::append_row(int from, std::int64_t first,
                                                                   std::int64_t second,
                                                                   int fraction) {
  constexpr int kBits = 40;
  const int own = state_of(slots_.size());
  const auto element = [&](int column) {
    std::uint32_t none = 0;
    if (column <= from) {
      std::int64_t sum = wide::scale(factor_.at(from, column), kBits - factor_.bits(from), none);
      if (kWorld && column == 0) {  // J (landmark - vehicle) by the heading
        const int slot = slots_.size();
        const FixedLength by = from == 1 ? -relative(slot, 1) : relative(slot, 0);
        const std::int64_t part = std::int64_t{by.raw()} * factor_.at(0, 0);
        const int shift = kBits - FixedLength::kFractionBits - factor_.bits(0);
        sum = wide::add(sum, wide::scale(part, shift, none), none);
      }
      return sum;
    }
    if (column < own) return std::int64_t{0};
    return wide::scale(column == own ? first : second, kBits - fraction, none);
  };
  factor_.append(kBits, element, saturations_);
}

}  // namespace cairn
