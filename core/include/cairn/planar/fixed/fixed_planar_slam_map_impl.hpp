#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"
#include "cairn/planar/fixed/map_frame.hpp"

// FixedPlanarSlam: landmarks and remembered positions.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::make_room(
    LandmarkId id, LandmarkId* replaced, detail::NeededLandmarks needed) {
  if (id == kNoLandmark) return Status::kInvalidArgument;
  if (find(id) >= 0) return Status::kDuplicate;
  if (replaced != nullptr) *replaced = kNoLandmark;
  const auto& slots = state_.slots();
  if (!slots.full()) return Status::kOk;
  const int slot = parameters_.replace_after > 0
                       ? slots.replaceable(records_.updates(),
                                           static_cast<std::uint32_t>(parameters_.replace_after))
                       : -1;
  const LandmarkId leaving = slot < 0 ? kNoLandmark : slots.id(slot);
  if (slot < 0 || needed.has(leaving)) {
    ++health_.landmarks_refused;
    return Status::kFull;
  }
  if (replaced != nullptr) *replaced = leaving;
  remove_states(slot);
  ++health_.landmarks_replaced;
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::remove_states(int slot) {
  errors_.remove(state_of(slot));
  state_.remove(slot);
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::remove_landmark(int slot) {
  if (!initialised_) return Status::kNotInitialised;
  if (slot < 0 || slot >= landmark_count()) return Status::kNotFound;
  remove_states(slot);
  ++health_.landmarks_removed;
  return Status::kOk;
}

/// What rested may move by now, and the error that the first landmark shares is the world's.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::prepare_to_append(bool shares) {
  end_rest();
  if (shares && landmark_count() == 0) {
    errors_.share_pose_error(state_, saturations_);
  } else {
    absorb_motion();
  }
}

/// A landmark that the state has placed: `rows` of the states before, and `noise`.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::enter(
    LandmarkId id, const detail::FixedStateRow (&rows)[3], const detail::FixedCholesky3& noise,
    int spare, bool pinned) {
  errors_.append(rows, noise, spare, saturations_);
  state_.enter(id, records_.updates(), pinned);
  ++health_.landmarks_added;
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
  prepare_to_append(!kWorld);
  detail::FixedSighting sighting;
  (void)linearise(seen, state_.axes(), FixedLength(), FixedLength(), FixedLength(), sighting,
                  saturations_);
  detail::FixedStateRow rows[3];
  state_.place_on_plane(x, y, rows, saturations_);
  if (kWorld) {  // J (landmark - vehicle) by the heading
    for (int axis = 0; axis < 2; ++axis) {
      const FixedLength by = state_.relative(landmark_count(), 1 - axis);
      rows[axis].add(0, axis == 0 ? -by.raw() : by.raw(), FixedLength::kFractionBits);
    }
  }
  enter(id, rows, sighting.noise(), 1);
  return Status::kOk;
}

/// add_landmark(), and where `by_path` is given add_landmark_on_path().
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::add_seen(
    LandmarkId id, const FixedLength (&y)[3], const FixedCovariance3& noise, LandmarkId past,
    const FixedLength (*by_path)[2], LandmarkId* replaced) {
  if (!initialised_) return Status::kNotInitialised;
  if (LandmarkDim != 3) return Status::kInvalidArgument;
  detail::FixedCholesky3 own;
  std::uint32_t none = 0;
  if (!detail::cholesky(noise, own, none) ||
      !detail::cholesky(detail::turned(noise, state_.rotation(), none), own, none)) {
    return Status::kInvalidArgument;
  }
  if (by_path != nullptr && find(past) < 0) return Status::kNotFound;
  const Status status =
      make_room(id, replaced, {by_path != nullptr ? past : LandmarkId{kNoLandmark}});
  if (!ok(status)) return status;
  prepare_to_append(true);
  const detail::FixedRotation rotation = state_.rotation();
  (void)detail::cholesky(detail::turned(noise, rotation, none), own, saturations_);
  detail::FixedStateRow rows[3];
  state_.place_beside_vehicle(rotation, y, rows, saturations_);
  if (by_path != nullptr) state_.add_path(rotation, find(past), by_path, rows, saturations_);
  enter(id, rows, own, by_path == nullptr ? 2 : Errors::kFullRow);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::add_landmark(
    LandmarkId id, const FixedLength (&y)[3], const FixedCovariance3& noise, LandmarkId* replaced) {
  return add_seen(id, y, noise, kNoLandmark, nullptr, replaced);
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::add_landmark_on_path(
    LandmarkId id, const FixedLength (&y)[3], const FixedCovariance3& noise, LandmarkId past,
    const FixedLength (&by_path)[3][2], LandmarkId* replaced) {
  return add_seen(id, y, noise, past, by_path, replaced);
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::add_position(LandmarkId id) {
  if (!initialised_) return Status::kNotInitialised;
  if (LandmarkDim != 3) return Status::kInvalidArgument;
  const Status status = make_room(id, nullptr);
  if (!ok(status)) return status;
  prepare_to_append(true);
  detail::FixedStateRow rows[3];
  state_.place_beside_vehicle(detail::FixedRotation(), {}, rows, saturations_);
  enter(id, rows, detail::FixedCholesky3(), 2, true);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::add_frame_position(
    LandmarkId id, const FixedCoordinate (&p_world)[3], const FixedCovariance3& covariance,
    LandmarkId reference) {
  if (!initialised_) return Status::kNotInitialised;
  detail::FixedCholesky3 own;
  std::uint32_t none = 0;
  if (LandmarkDim != 3 || !detail::cholesky(covariance, own, none)) return Status::kInvalidArgument;
  if (reference != kNoLandmark && find(reference) < 0) return Status::kNotFound;
  const Status status = make_room(id, nullptr, {reference});
  if (!ok(status)) return status;
  prepare_to_append(false);
  state_.place_in_world(p_world, saturations_);
  detail::FixedStateRow rows[3];
  for (int axis = 0; axis < 3; ++axis) {
    if (reference != kNoLandmark) {
      rows[axis].add(state_of(find(reference)) + axis, 1, 0);
    } else if (axis < 2) {
      rows[axis].add(1 + axis, 1, 0);
    }
  }
  enter(id, rows, own, Errors::kFullRow, true);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::add_framed_landmark(
    LandmarkId id, const FixedCoordinate (&p_world)[3], const FixedCovariance3& covariance,
    LandmarkId origin, LandmarkId ahead, LandmarkId* replaced) {
  if (!initialised_) return Status::kNotInitialised;
  detail::FixedCholesky3 own;
  std::uint32_t none = 0;
  if (LandmarkDim != 3 || !detail::cholesky(covariance, own, none)) return Status::kInvalidArgument;
  if (find(origin) < 0 || find(ahead) < 0) return Status::kNotFound;
  using Frame = detail::FixedMapFrame<State>;
  FixedLength lambda[2];
  std::uint32_t lost = 0;
  if (!Frame(state_, find(origin), find(ahead))
           .place(state_.from_anchor(p_world[0], 0, lost), state_.from_anchor(p_world[1], 1, lost),
                  lambda, lost)) {
    return Status::kInvalidArgument;
  }
  const Status status = make_room(id, replaced, {origin, ahead});
  if (!ok(status)) return status;
  saturations_ += lost;
  prepare_to_append(false);
  state_.place_in_world(p_world, saturations_);
  detail::FixedStateRow rows[3];
  Frame(state_, find(origin), find(ahead)).landmark_rows(lambda, rows);
  enter(id, rows, own, Errors::kFullRow);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::widen_frame(LandmarkId origin,
                                                                      LandmarkId ahead,
                                                                      FixedVariance position,
                                                                      FixedVariance heading) {
  constexpr int kBits = 40;
  const int slots[2] = {find(origin), find(ahead)};
  if (slots[0] < 0 || slots[1] < 0) return Status::kNotFound;
  if (position.raw() < 0 || heading.raw() < 0 || LandmarkDim != 3) return Status::kInvalidArgument;
  end_rest();
  const auto sigma = [&](FixedVariance variance) {
    const FixedRoot root = square_root(variance.raw(), FixedVariance::kFractionBits);
    return wide::scale(root.mantissa, kBits - root.bits, saturations_);
  };
  using Frame = detail::FixedMapFrame<State>;
  std::int64_t noise[Frame::kNoiseColumns][Frame::kNoiseStates];
  int states[Frame::kNoiseStates];
  Frame(state_, slots[0], slots[1])
      .noise(sigma(position), sigma(heading), noise, states, saturations_);
  errors_.add_noise(noise, states, kBits, saturations_);
  return Status::kOk;
}

}  // namespace cairn
