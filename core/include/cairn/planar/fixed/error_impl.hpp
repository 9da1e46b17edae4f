#pragma once

#include "cairn/planar/fixed/error.hpp"

namespace cairn::detail {

template <class State, FixedError Error>
void FixedPlanarError<State, Error>::start(const FixedPoseCovariance& covariance,
                                           const FixedCovariance2* tilt,
                                           std::uint32_t& saturations) {
  clear(tilt, saturations);
  shared_ = kWorld ? FixedPoseCovariance() : covariance;
  if (kWorld) motion_.start(covariance);
  for (FixedCoordinate& coordinate : moved_) coordinate = FixedCoordinate();
}

/// A pose without an error, and a tilt of this covariance.
template <class State, FixedError Error>
void FixedPlanarError<State, Error>::clear(const FixedCovariance2* tilt,
                                           std::uint32_t& saturations) {
  motion_.clear();
  factor_.clear();
  for (int i = 0; i < State::kPoseStates; ++i) factor_.append();
  if (tilt == nullptr) return;
  // A third state of variance 1 beside it, for the sake of the function.
  const FixedCovariance3 three = {tilt->xx, tilt->xy, tilt->yy,
                                  {},       {},       FixedVariance::nearest(1.0)};
  FixedCholesky3 own;
  (void)cholesky(three, own, saturations);
  for (int row = 0; row < 2; ++row) {
    const auto element = [&](int column) {
      return column < State::kTiltState ? std::int64_t{0} : own.at(row, column - State::kTiltState);
    };
    factor_.append(FixedCholesky3::kBits, element, saturations);
  }
}

template <class State, FixedError Error>
void FixedPlanarError<State, Error>::propagate(const FixedIncrement& increment,
                                               const FixedStep& step, std::uint32_t& saturations) {
  motion_.move(increment, step, saturations);
  if (!kWorld) return;
  moved_[0] = add(moved_[0], step.x, saturations);
  moved_[1] = add(moved_[1], step.y, saturations);
}

/// The world's error: that of the position turns with the heading's over the way since the last
/// time.
template <class State, FixedError Error>
void FixedPlanarError<State, Error>::turn_with_heading(std::uint32_t& saturations) {
  if (moved_[0].raw() == 0 && moved_[1].raw() == 0) return;
  const FixedLength by[2] = {-convert<FixedLength>(moved_[1], saturations),
                             convert<FixedLength>(moved_[0], saturations)};
  shear(1, by, saturations);
  for (FixedCoordinate& moved : moved_) moved = FixedCoordinate();
}

/// Writes an element of the column that scratch_ holds, for a row with room for it and `more`.
template <class State, FixedError Error>
bool FixedPlanarError<State, Error>::enter(int row, std::int64_t value, std::uint64_t more,
                                           int fraction, std::uint32_t& saturations) {
  const int length = wide::bit_length(wide::magnitude(value) | more);
  const bool room = factor_.make_room(row, 2 * (length + 1 - fraction), saturations);
  scratch_[row] = room ? factor_.to_row(row, value, fraction) : 0;
  return room;
}

/// -J p (heading) on every point p of the group's error, and the rest on the vehicle's position.
template <class State, FixedError Error>
void FixedPlanarError<State, Error>::absorb_motion(const State& state, std::uint32_t& saturations) {
  if (kWorld) turn_with_heading(saturations);
  if (motion_.empty()) return;
  using Columns = typename FixedMotionNoise::Columns;
  const Columns c = motion_.columns(saturations);
  motion_.clear();
  const auto turned = [&](FixedLength by) {  // heading x coordinate, Columns::kBits
    if (kWorld) return std::int64_t{0};
    const std::int64_t product = std::int64_t{c.heading.mantissa} * by.raw();
    return wide::scale(product, Columns::kBits - c.heading.bits - FixedLength::kFractionBits,
                       saturations);
  };
  const auto write = [&](int row, std::int64_t value) {
    enter(row, value, 0, Columns::kBits, saturations);
  };
  enter(0, c.heading.mantissa, 0, c.heading.bits, saturations);
  const std::int64_t along[2] = {wide::add(c.along[0], turned(state.vehicle(1)), saturations),
                                 wide::add(c.along[1], -turned(state.vehicle(0)), saturations)};
  bool room[2];
  for (int i = 0; i < 2; ++i) {
    room[i] = enter(1 + i, along[i], wide::magnitude(c.rest[0][i]) | wide::magnitude(c.rest[1][i]),
                    Columns::kBits, saturations);
  }
  for (int row = State::kPoseStates; row < state.vehicle_states(); ++row) write(row, 0);
  for (int slot = 0; slot < state.count(); ++slot) {
    const int row = state.state_of(slot);
    write(row, turned(state.landmark(slot, 1)));
    write(row + 1, -turned(state.landmark(slot, 0)));
    if constexpr (State::kLandmarkDim == 3) write(row + 2, 0);
  }
  factor_.absorb(scratch_, 0);
  for (int k = 0; k < 2; ++k) {
    wide::clear(scratch_, factor_.size());
    for (int axis = 0; axis < 2; ++axis) {
      if (!room[axis]) continue;
      scratch_[1 + axis] = factor_.to_row(1 + axis, c.rest[k][axis], Columns::kBits);
    }
    factor_.absorb(scratch_, 1);
  }
}

template <class State, FixedError Error>
void FixedPlanarError<State, Error>::share_pose_error(const State& state,
                                                      std::uint32_t& saturations) {
  shared_ = pose_covariance(state, saturations);
  const FixedCovariance2 tilt = state.tilts() ? tilt_covariance() : FixedCovariance2();
  clear(state.tilts() ? &tilt : nullptr, saturations);
}

template <class State, FixedError Error>
void FixedPlanarError<State, Error>::drift_world(const State& state, FixedVariance position,
                                                 FixedVariance heading,
                                                 std::uint32_t& saturations) {
  FixedMotionNoise drift;
  drift.widen(position, heading, saturations);
  const FixedPoseCovariance more = drift.about(state.vehicle(0), state.vehicle(1), saturations);
  const auto enter = [&](FixedVariance& to, FixedVariance by) { to = add(to, by, saturations); };
  enter(shared_.heading, more.heading);
  enter(shared_.x_heading, more.x_heading);
  enter(shared_.y_heading, more.y_heading);
  enter(shared_.position.xx, more.position.xx);
  enter(shared_.position.xy, more.position.xy);
  enter(shared_.position.yy, more.position.yy);
}

template <class State, FixedError Error>
void FixedPlanarError<State, Error>::shrink_tilt(const FixedTiltStep& step,
                                                 std::uint32_t& saturations) {
  constexpr int kBits = FixedTiltStep::kNoiseBits;
  for (int k = 0; k < 2; ++k) {
    const int row = State::kTiltState + k;
    factor_.shrink_row(row, step.left);
    const int length = wide::bit_length(static_cast<std::uint64_t>(step.noise[k]));
    if (!factor_.make_room(row, 2 * (length - kBits), saturations)) continue;
    wide::clear(scratch_, factor_.size());
    scratch_[row] = factor_.to_row(row, step.noise[k], kBits);
    factor_.absorb(scratch_, row);
  }
}

/// xi becomes xi + J x e.
template <class State, FixedError Error>
void FixedPlanarError<State, Error>::recentre(const State& state, std::uint32_t& saturations) {
  const FixedLength by[2] = {-state.vehicle(1), state.vehicle(0)};
  shear(1, by, saturations);
  for (int slot = 0; slot < state.count(); ++slot) shear(state.state_of(slot), by, saturations);
  FixedMotionNoise shared;
  shared.start(shared_);
  shared_ = shared.about(-state.vehicle(0), -state.vehicle(1), saturations);
}

/// Adds `by` times the heading's error to two states.
template <class State, FixedError Error>
void FixedPlanarError<State, Error>::shear(int first, const FixedLength (&by)[2],
                                           std::uint32_t& saturations) {
  constexpr int kMore = 1;  // the two parts of an element may add up
  const std::int64_t heading = factor_.at(0, 0);
  const int bits = factor_.bits(0) + FixedLength::kFractionBits;
  for (int axis = 0; axis < 2; ++axis) {
    const std::int64_t part = heading * by[axis].raw();
    const int length = wide::bit_length(wide::magnitude(part));
    if (factor_.make_room(first + axis, 2 * (length - bits), saturations, kMore)) {
      factor_.add(first + axis, 0, part, bits, saturations);
    }
  }
}

template <class State, FixedError Error>
void FixedPlanarError<State, Error>::append(const FixedStateRow (&rows)[3],
                                            const FixedCholesky3& noise, int spare,
                                            std::uint32_t& saturations) {
  constexpr int kBits = FixedCholesky3::kBits;
  const int first = factor_.size();
  for (int axis = 0; axis < State::kLandmarkDim; ++axis) {
    const FixedStateRow& row = rows[axis];
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
    factor_.append(kBits, element, saturations, spare);
  }
}

template <class State, FixedError Error>
void FixedPlanarError<State, Error>::widen_landmark(int first, FixedLength sigma, int doublings,
                                                    std::uint32_t& saturations) {
  const int fraction = FixedLength::kFractionBits - doublings;
  const int length = wide::bit_length(static_cast<std::uint64_t>(sigma.raw())) - fraction;
  for (int axis = 0; axis < State::kLandmarkDim; ++axis) {
    const int row = first + axis;
    if (!factor_.make_room(row, 2 * length, saturations)) continue;
    wide::clear(scratch_, factor_.size());
    scratch_[row] = factor_.to_row(row, sigma.raw(), fraction);
    factor_.absorb(scratch_, row);
  }
}

template <class State, FixedError Error>
template <int Columns, int Rows>
void FixedPlanarError<State, Error>::add_noise(const std::int64_t (&columns)[Columns][Rows],
                                               const int (&states)[Rows], int fraction,
                                               std::uint32_t& saturations) {
  bool room[Rows];
  int first = states[0];
  for (int r = 0; r < Rows; ++r) {
    std::uint64_t largest = 0;
    for (const auto& column : columns) largest |= wide::magnitude(column[r]);
    const int length = wide::bit_length(largest) + 1 - fraction;
    room[r] = factor_.make_room(states[r], 2 * length, saturations);
    first = states[r] < first ? states[r] : first;
  }
  for (const auto& column : columns) {
    wide::clear(scratch_, factor_.size());
    for (int r = 0; r < Rows; ++r) {
      if (room[r]) scratch_[states[r]] = factor_.to_row(states[r], column[r], fraction);
    }
    factor_.absorb(scratch_, first);
  }
}

}  // namespace cairn::detail
