#pragma once

#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: the frame of an old map, held by two positions.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::place_in_world(
    const FixedCoordinate (&p_world)[3]) {
  const int slot = slots_.size();
  for (int axis = 0; axis < LandmarkDim; ++axis) {
    p_[slot][axis] =
        axis < 2 ? subtract(p_world[axis], anchor_[axis], saturations_) : p_world[axis];
  }
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
  const Status status = make_room(id, nullptr);
  if (!ok(status)) return status;
  if (reference != kNoLandmark && find(reference) < 0) return Status::kNotFound;  // it made room
  prepare_to_append(false);
  place_in_world(p_world);
  detail::FixedStateRow rows[3];
  for (int axis = 0; axis < 3; ++axis) {
    if (reference != kNoLandmark) {
      rows[axis].add(state_of(find(reference)) + axis, 1, 0);
    } else if (axis < 2) {
      rows[axis].add(1 + axis, 1, 0);
    }
  }
  append_states(rows, own, kFullRow);
  enter(id, true);
  return Status::kOk;
}

/// Place of a point, from the anchor, in the frame that two landmarks hold, in complex numbers of
/// the plane: point = origin + lambda (ahead - origin). False where both are in one place.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
bool FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::place_in_frame(
    FixedCoordinate x, FixedCoordinate y, int origin, int ahead, FixedLength (&lambda)[2],
    std::uint32_t& saturations) const {
  constexpr int kBits = FixedLength::kFractionBits;
  const auto from_origin = [&](FixedCoordinate a, int axis) {
    return std::int64_t{
        convert<FixedLength>(subtract(a, p_[origin][axis], saturations), saturations).raw()};
  };
  const std::int64_t arm[2] = {from_origin(p_[ahead][0], 0), from_origin(p_[ahead][1], 1)};
  const std::int64_t d[2] = {from_origin(x, 0), from_origin(y, 1)};
  const std::int64_t squared = wide::add(arm[0] * arm[0], arm[1] * arm[1], saturations);
  if (squared == 0) return false;
  const std::int64_t along = wide::add(d[0] * arm[0], d[1] * arm[1], saturations);
  const std::int64_t across = wide::add(d[1] * arm[0], -(d[0] * arm[1]), saturations);
  const auto over = [&](std::int64_t part) {
    return detail::to_fixed<FixedLength>(wide::divide(part, squared, kBits, saturations),
                                         saturations);
  };
  lambda[0] = over(along);
  lambda[1] = over(across);
  return true;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::add_framed_landmark(
    LandmarkId id, const FixedCoordinate (&p_world)[3], const FixedCovariance3& covariance,
    LandmarkId origin, LandmarkId ahead, LandmarkId* replaced) {
  constexpr int kBits = FixedLength::kFractionBits;
  if (!initialised_) return Status::kNotInitialised;
  detail::FixedCholesky3 own;
  std::uint32_t none = 0;
  if (LandmarkDim != 3 || !detail::cholesky(covariance, own, none)) return Status::kInvalidArgument;
  if (find(origin) < 0 || find(ahead) < 0) return Status::kNotFound;
  FixedLength lambda[2];
  if (!place_in_frame(subtract(p_world[0], anchor_[0], saturations_),
                      subtract(p_world[1], anchor_[1], saturations_), find(origin), find(ahead),
                      lambda, saturations_)) {
    return Status::kInvalidArgument;
  }
  const Status status = make_room(id, replaced);
  if (!ok(status)) return status;
  if (find(origin) < 0 || find(ahead) < 0) return Status::kNotFound;  // it made room
  prepare_to_append(false);
  place_in_world(p_world);
  const int at_origin = state_of(find(origin));
  const int at_ahead = state_of(find(ahead));
  detail::FixedStateRow rows[3];
  const std::int64_t along = lambda[0].raw();
  for (int i = 0; i < 2; ++i) {
    const std::int64_t across = i == 0 ? -std::int64_t{lambda[1].raw()} : lambda[1].raw();
    rows[i].add(at_origin + i, (std::int64_t{1} << kBits) - along, kBits);
    rows[i].add(at_origin + 1 - i, -across, kBits);
    rows[i].add(at_ahead + i, along, kBits);
    rows[i].add(at_ahead + 1 - i, across, kBits);
  }
  rows[2].add(at_origin + 2, 1, 0);
  append_states(rows, own, kFullRow);
  enter(id);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::widen_frame(LandmarkId origin,
                                                                      LandmarkId ahead,
                                                                      FixedVariance position,
                                                                      FixedVariance heading) {
  constexpr int kBits = 40;
  constexpr int kRows = 5;
  const int slots[2] = {find(origin), find(ahead)};
  if (slots[0] < 0 || slots[1] < 0) return Status::kNotFound;
  if (position.raw() < 0 || heading.raw() < 0 || LandmarkDim != 3) return Status::kInvalidArgument;
  end_rest();
  const auto sigma = [&](FixedVariance variance) {
    const FixedRoot root = square_root(variance.raw(), FixedVariance::kFractionBits);
    return wide::scale(root.mantissa, kBits - root.bits, saturations_);
  };
  const std::int64_t shift = sigma(position);
  const std::int64_t turn = sigma(heading);
  // Rows x and y of both, and the height of the first; columns: the shifts by x and y, the turn
  // about the vehicle, the shift by z.
  std::int64_t noise[4][kRows] = {{shift, 0, shift, 0, 0}, {0, shift, 0, shift, 0}, {}, {}};
  noise[3][4] = shift;
  int rows[kRows];
  for (int k = 0; k < 2; ++k) {
    const FixedLength by_turn[2] = {-relative(slots[k], 1), relative(slots[k], 0)};
    for (int axis = 0; axis < 2; ++axis) {
      rows[2 * k + axis] = state_of(slots[k]) + axis;
      noise[2][2 * k + axis] =
          wide::multiply(turn, by_turn[axis].raw(), FixedLength::kFractionBits, saturations_);
    }
  }
  rows[4] = state_of(slots[0]) + 2;
  bool room[kRows];
  int first = rows[0];
  for (int r = 0; r < kRows; ++r) {
    std::uint64_t largest = 0;
    for (const auto& column : noise) largest |= wide::magnitude(column[r]);
    const int length = wide::bit_length(largest) + 1 - kBits;
    room[r] = factor_.make_room(rows[r], 2 * length, saturations_);
    first = rows[r] < first ? rows[r] : first;
  }
  for (const auto& column : noise) {
    for (int i = 0; i < factor_.size(); ++i) scratch_[i] = 0;
    for (int r = 0; r < kRows; ++r) {
      if (room[r]) scratch_[rows[r]] = factor_.to_row(rows[r], column[r], kBits);
    }
    factor_.absorb(scratch_, first);
  }
  return Status::kOk;
}

/// In complex numbers of the plane the pose in the frame is (x - origin) / (ahead - origin), as
/// PlanarSlam::framed_pose_covariance(). Of odometry's noise that is the vehicle's own.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
FixedPoseCovariance FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::framed_pose_covariance(
    LandmarkId origin, LandmarkId ahead) const {
  constexpr int kBits = FixedLength::kFractionBits;
  constexpr int kTurnBits = 24;
  std::uint32_t none = 0;
  const int slots[2] = {find(origin), find(ahead)};
  FixedLength lambda[2];
  if (slots[0] < 0 || slots[1] < 0 ||
      !place_in_frame(x_[0], x_[1], slots[0], slots[1], lambda, none)) {
    return {};
  }
  const int o = state_of(slots[0]);
  const int a = state_of(slots[1]);
  const std::int64_t along = lambda[0].raw();
  const std::int64_t across = lambda[1].raw();
  const std::int64_t before = along - (std::int64_t{1} << kBits);
  const std::int64_t arm[2] = {
      convert<FixedLength>(subtract(p_[slots[1]][0], p_[slots[0]][0], none), none).raw(),
      convert<FixedLength>(subtract(p_[slots[1]][1], p_[slots[0]][1], none), none).raw()};
  const std::int64_t squared = wide::add(arm[0] * arm[0], arm[1] * arm[1], none);
  const auto per_metre = [&](std::int64_t part) {
    return std::int64_t{wide::narrow(wide::divide(part, squared, kTurnBits + kBits, none), none)};
  };
  const std::int64_t turn[2] = {per_metre(arm[1]), per_metre(-arm[0])};
  detail::FixedStateRow rows[3];
  const std::int64_t by_origin[2][2] = {{before, -across}, {across, before}};
  const std::int64_t by_ahead[2][2] = {{-along, across}, {-across, -along}};
  for (int axis = 0; axis < 2; ++axis) {
    rows[axis].add(1 + axis, 1, 0);
    for (int k = 0; k < 2; ++k) {
      rows[axis].add(o + k, by_origin[axis][k], kBits);
      rows[axis].add(a + k, by_ahead[axis][k], kBits);
    }
    rows[2].add(o + axis, -turn[axis], kTurnBits);
    rows[2].add(a + axis, turn[axis], kTurnBits);
  }
  const FixedCovariance3 own = covariance_of(rows);
  const FixedCovariance2& waiting = motion_.position();
  const auto both = [&](FixedVariance x, FixedVariance y) { return add(x, y, none); };
  return {{both(own.xx, waiting.xx), both(own.xy, waiting.xy), both(own.yy, waiting.yy)},
          both(own.xz, motion_.x_heading()),
          both(own.yz, motion_.y_heading()),
          both(own.zz, motion_.heading())};
}

}  // namespace cairn
