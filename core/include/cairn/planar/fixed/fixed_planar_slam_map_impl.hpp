#pragma once

#include "cairn/planar/fixed/covariance3.hpp"
#include "cairn/planar/fixed/fixed_planar_slam.hpp"

// FixedPlanarSlam: landmarks in space, remembered positions, and where the vehicle was recognised.

namespace cairn {

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
detail::FixedRotation FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::vehicle_axes() const {
  const detail::FixedAxes axes(heading_);
  const auto level = detail::rotation_about_vertical(axes.cosine, axes.sine);
  return tilts() ? level * detail::rotation_of(tilt_) : level;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::enter(LandmarkId id, bool pinned) {
  slots_.push(id, updates_);
  slots_.statistics(slots_.size() - 1).pinned = pinned;
  ++health_.landmarks_added;
}

/// What rested may move by now, and the error that the first landmark shares is the world's.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::prepare_to_append(bool shares) {
  end_rest();
  if (shares && slots_.size() == 0) {
    share_pose_error();
  } else {
    absorb_motion();
  }
  order_[slots_.size()] = static_cast<std::int16_t>(slots_.size());
}

/// Appends the states of a landmark: `rows` of those before, and `noise`. Of a row at most 4^spare
/// elements are not zero.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::append_states(
    const detail::FixedStateRow (&rows)[3], const detail::FixedCholesky3& noise, int spare) {
  constexpr int kBits = detail::FixedCholesky3::kBits;
  const int first = state_of(slots_.size());
  for (int axis = 0; axis < LandmarkDim; ++axis) {
    const detail::FixedStateRow& row = rows[axis];
    const auto element = [&](int column) {
      std::uint32_t none = 0;
      std::int64_t sum = column >= first && column - first <= axis ? noise.at(axis, column - first)
                                                                   : std::int64_t{0};
      for (int k = 0; k < row.count; ++k) {
        if (column > row.state[k]) continue;
        const std::int64_t part = row.coefficient[k] * factor_.at(row.state[k], column);
        const int shift = kBits - row.bits[k] - factor_.bits(row.state[k]);
        sum = wide::add(sum, wide::scale(part, shift, none), none);
      }
      return sum;
    };
    factor_.append(kBits, element, saturations_, spare);
  }
}

/// Places the next landmark `y` from the vehicle in its axes; its errors are the vehicle's own and
/// the tilt's turn about its axes.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::place_beside_vehicle(
    const detail::FixedRotation& rotation, const FixedLength (&y)[3],
    detail::FixedStateRow (&rows)[3]) {
  FixedLength seen[3];
  rotation.turn(y, seen, saturations_);
  const int slot = slots_.size();
  for (int axis = 0; axis < LandmarkDim; ++axis) {
    const auto at = convert<FixedCoordinate>(seen[axis], saturations_);
    p_[slot][axis] = axis < 2 ? add(x_[axis], at, saturations_) : at;
    if (axis < 2) rows[axis].add(1 + axis, 1, 0);
  }
  if (!tilts()) return;
  const detail::FixedAxes axes(heading_);
  const detail::FixedCameraView level({}, {}, axes.cosine, axes.sine, &tilt_, saturations_);
  for (int axis = 0; axis < LandmarkDim; ++axis) {
    const int next = (axis + 1) % 3;
    const int last = (axis + 2) % 3;
    for (int k = 0; k < 2; ++k) {
      const FixedLength by_tilt = subtract(
          multiply<FixedLength>(seen[last], level.axes[k][next], saturations_),
          multiply<FixedLength>(seen[next], level.axes[k][last], saturations_), saturations_);
      rows[axis].add(kTiltState + k, by_tilt.raw(), FixedLength::kFractionBits);
    }
  }
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
      !detail::cholesky(detail::turned(noise, vehicle_axes(), none), own, none)) {
    return Status::kInvalidArgument;
  }
  if (by_path != nullptr && find(past) < 0) return Status::kNotFound;
  const Status status = make_room(id, replaced);
  if (!ok(status)) return status;
  if (by_path != nullptr && find(past) < 0) return Status::kNotFound;  // it made room
  prepare_to_append(true);
  const detail::FixedRotation rotation = vehicle_axes();
  (void)detail::cholesky(detail::turned(noise, rotation, none), own, saturations_);
  detail::FixedStateRow rows[3];
  place_beside_vehicle(rotation, y, rows);
  if (by_path != nullptr) add_path(rotation, find(past), by_path, rows);
  append_states(rows, own, by_path == nullptr ? 2 : kFullRow);
  enter(id);
  return Status::kOk;
}

/// The error of the way from the position in slot `past`.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::add_path(
    const detail::FixedRotation& rotation, int past, const FixedLength (*by_path)[2],
    detail::FixedStateRow (&rows)[3]) {
  const detail::FixedAxes axes(heading_);
  FixedLength turned[2][3];
  for (int k = 0; k < 2; ++k) {
    const FixedLength column[3] = {by_path[0][k], by_path[1][k], by_path[2][k]};
    rotation.turn(column, turned[k], saturations_);
  }
  for (int axis = 0; axis < 3; ++axis) {
    // From the vehicle's axes to the world's.
    FixedLength by_world[2];
    axes.turn(turned[0][axis], turned[1][axis], by_world[0], by_world[1], saturations_);
    for (int k = 0; k < 2; ++k) {
      rows[axis].add(1 + k, by_world[k].raw(), FixedLength::kFractionBits);
      rows[axis].add(state_of(past) + k, -std::int64_t{by_world[k].raw()},
                     FixedLength::kFractionBits);
    }
  }
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
  place_beside_vehicle(detail::FixedRotation(), {}, rows);
  append_states(rows, detail::FixedCholesky3(), 2);
  enter(id, true);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
Status FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::drift_world(FixedVariance position,
                                                                      FixedVariance heading) {
  if (!initialised_) return Status::kNotInitialised;
  if (position.raw() < 0 || heading.raw() < 0) return Status::kInvalidArgument;
  if (kWorld) return Status::kOk;
  detail::FixedMotionNoise drift;
  drift.widen(position, heading, saturations_);
  const FixedPoseCovariance more = drift.about(vehicle(0), vehicle(1), saturations_);
  const auto enter = [&](FixedVariance& to, FixedVariance by) { to = add(to, by, saturations_); };
  enter(shared_.heading, more.heading);
  enter(shared_.x_heading, more.x_heading);
  enter(shared_.y_heading, more.y_heading);
  enter(shared_.position.xx, more.position.xx);
  enter(shared_.position.xy, more.position.xy);
  enter(shared_.position.yy, more.position.yy);
  return Status::kOk;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::move_pose(const FixedPose& pose) {
  x_[0] = subtract(pose.x, anchor_[0], saturations_);
  x_[1] = subtract(pose.y, anchor_[1], saturations_);
  heading_ = wrapped_angle(pose.heading.raw());
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
typename FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::Placement
FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::place(const FixedPose& pose,
                                                         FixedVariance position,
                                                         FixedVariance heading) {
  const Placement before = {mean_pose(), motion_};
  if (kWorld) return before;
  move_pose(pose);
  const FixedCovariance2& own = motion_.position();
  const FixedVariance larger = own.xx < own.yy ? own.yy : own.xx;
  const FixedVariance turn = motion_.heading();
  const auto bounded = [](FixedVariance variance, FixedVariance most) {
    const FixedVariance least = variance < most ? variance : most;
    return least.raw() < 0 ? FixedVariance() : least;
  };
  motion_.clear();
  motion_.widen(bounded(larger, position), bounded(turn, heading), saturations_);
  return before;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::put_back(const Placement& before) {
  if (kWorld) return;
  move_pose(before.pose);
  motion_ = before.waiting_noise;
}

template <int MaxLandmarks, int LandmarkDim, FixedError Error>
bool FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::recentre() {
  constexpr FixedVariance kMost_m = FixedVariance::nearest(0.1);
  constexpr std::int64_t kNear = std::int64_t{1} << 40;  // 1 m^2
  if (kWorld || !initialised_) return false;
  const std::int64_t x[2] = {vehicle(0).raw(), vehicle(1).raw()};
  const std::int64_t squared = wide::add(x[0] * x[0], x[1] * x[1], saturations_);
  if (squared <= kNear) return false;
  const FixedRoot distance = square_root(squared, 2 * FixedLength::kFractionBits);
  const FixedVariance turn = error_covariance(saturations_).heading;
  if (wide::multiply(turn.raw(), distance.mantissa, distance.bits, saturations_) <= kMost_m.raw()) {
    return false;
  }
  move_anchor();
  return true;
}

/// An error of the heading turns about the vehicle from now on: xi becomes xi + J x e.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::move_anchor() {
  const FixedLength by[2] = {-vehicle(1), vehicle(0)};
  shear(1, by);
  for (int slot = 0; slot < slots_.size(); ++slot) {
    shear(state_of(slot), by);
    for (int axis = 0; axis < 2; ++axis) {
      p_[slot][axis] = subtract(p_[slot][axis], x_[axis], saturations_);
    }
  }
  detail::FixedMotionNoise shared;
  shared.start(shared_);
  shared_ = shared.about(-vehicle(0), -vehicle(1), saturations_);
  for (int axis = 0; axis < 2; ++axis) {
    anchor_[axis] = add(anchor_[axis], x_[axis], saturations_);
    x_[axis] = FixedCoordinate();
  }
}

/// Adds `by` times the heading's error to two states.
template <int MaxLandmarks, int LandmarkDim, FixedError Error>
void FixedPlanarSlam<MaxLandmarks, LandmarkDim, Error>::shear(int first,
                                                              const FixedLength (&by)[2]) {
  constexpr int kGrowth = 2;  // the two parts of an element may add up
  const std::int64_t heading = factor_.at(0, 0);
  const int bits = factor_.bits(0) + FixedLength::kFractionBits;
  for (int axis = 0; axis < 2; ++axis) {
    const std::int64_t part = heading * by[axis].raw();
    const int length = wide::bit_length(wide::magnitude(part));
    if (factor_.make_room(first + axis, 2 * (length - bits), saturations_, kGrowth)) {
      factor_.add(first + axis, 0, part, bits, saturations_);
    }
  }
}

}  // namespace cairn
