#pragma once

#include "cairn/planar/fixed/row_scaled_factor.hpp"
#include "cairn/planar/fixed/types.hpp"

namespace cairn::detail {

/// Frame of an old map, held by two positions of a FixedPlanarState. In complex numbers of the
/// plane a point in it is lambda = (point - origin) / (ahead - origin).
template <class State>
class FixedMapFrame {
 public:
  FixedMapFrame(const State& state, int origin_slot, int ahead_slot)
      : state_(state), origin_(origin_slot), ahead_(ahead_slot) {}

  /// Of a point, from the anchor. False where both positions are in one place.
  bool place(FixedCoordinate x, FixedCoordinate y, FixedLength (&lambda)[2],
             std::uint32_t& saturations) const;
  /// The error of a landmark at `lambda` that is as sure as the frame.
  void landmark_rows(const FixedLength (&lambda)[2], FixedStateRow (&rows)[3]) const;
  /// That of the vehicle's pose (x, y, heading) in the frame, where it is at `lambda`.
  void pose_rows(const FixedLength (&lambda)[2], FixedStateRow (&rows)[3]) const;

  static constexpr int kNoiseColumns = 4;
  static constexpr int kNoiseStates = 5;
  /// The frame shifts by x, y and z, each a deviation of `shift`, and turns about the vehicle by
  /// one of `turn`: x and y of both positions, and the height of the first.
  void noise(std::int64_t shift, std::int64_t turn,
             std::int64_t (&columns)[kNoiseColumns][kNoiseStates], int (&states)[kNoiseStates],
             std::uint32_t& saturations) const;

 private:
  static constexpr int kBits = FixedLength::kFractionBits;

  std::int64_t from_origin(FixedCoordinate at, int axis, std::uint32_t& saturations) const {
    const FixedCoordinate off = subtract(at, state_.landmark_at(origin_, axis), saturations);
    return convert<FixedLength>(off, saturations).raw();
  }

  const State& state_;
  int origin_;
  int ahead_;
};

template <class State>
bool FixedMapFrame<State>::place(FixedCoordinate x, FixedCoordinate y, FixedLength (&lambda)[2],
                                 std::uint32_t& saturations) const {
  const std::int64_t arm[2] = {from_origin(state_.landmark_at(ahead_, 0), 0, saturations),
                               from_origin(state_.landmark_at(ahead_, 1), 1, saturations)};
  const std::int64_t d[2] = {from_origin(x, 0, saturations), from_origin(y, 1, saturations)};
  const std::int64_t squared = wide::add(arm[0] * arm[0], arm[1] * arm[1], saturations);
  if (squared == 0) return false;
  const std::int64_t along = wide::add(d[0] * arm[0], d[1] * arm[1], saturations);
  const std::int64_t across = wide::add(d[1] * arm[0], -(d[0] * arm[1]), saturations);
  const auto over = [&](std::int64_t part) {
    return to_fixed<FixedLength>(wide::divide(part, squared, kBits, saturations), saturations);
  };
  lambda[0] = over(along);
  lambda[1] = over(across);
  return true;
}

template <class State>
void FixedMapFrame<State>::landmark_rows(const FixedLength (&lambda)[2],
                                         FixedStateRow (&rows)[3]) const {
  const int at_origin = state_.state_of(origin_);
  const int at_ahead = state_.state_of(ahead_);
  const std::int64_t along = lambda[0].raw();
  for (int i = 0; i < 2; ++i) {
    const std::int64_t across = i == 0 ? -std::int64_t{lambda[1].raw()} : lambda[1].raw();
    rows[i].add(at_origin + i, (std::int64_t{1} << kBits) - along, kBits);
    rows[i].add(at_origin + 1 - i, -across, kBits);
    rows[i].add(at_ahead + i, along, kBits);
    rows[i].add(at_ahead + 1 - i, across, kBits);
  }
  rows[2].add(at_origin + 2, 1, 0);
}

template <class State>
void FixedMapFrame<State>::pose_rows(const FixedLength (&lambda)[2],
                                     FixedStateRow (&rows)[3]) const {
  constexpr int kTurnBits = 24;
  std::uint32_t none = 0;
  const int o = state_.state_of(origin_);
  const int a = state_.state_of(ahead_);
  const std::int64_t along = lambda[0].raw();
  const std::int64_t across = lambda[1].raw();
  const std::int64_t before = along - (std::int64_t{1} << kBits);
  const std::int64_t arm[2] = {from_origin(state_.landmark_at(ahead_, 0), 0, none),
                               from_origin(state_.landmark_at(ahead_, 1), 1, none)};
  const std::int64_t squared = wide::add(arm[0] * arm[0], arm[1] * arm[1], none);
  const auto per_metre = [&](std::int64_t part) {
    return std::int64_t{wide::narrow(wide::divide(part, squared, kTurnBits + kBits, none), none)};
  };
  const std::int64_t turn[2] = {per_metre(arm[1]), per_metre(-arm[0])};
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
}

template <class State>
void FixedMapFrame<State>::noise(std::int64_t shift, std::int64_t turn,
                                 std::int64_t (&columns)[kNoiseColumns][kNoiseStates],
                                 int (&states)[kNoiseStates], std::uint32_t& saturations) const {
  const int slots[2] = {origin_, ahead_};
  for (auto& column : columns) {
    for (std::int64_t& element : column) element = 0;
  }
  for (int k = 0; k < 2; ++k) {
    const FixedLength by_turn[2] = {-state_.relative(slots[k], 1), state_.relative(slots[k], 0)};
    for (int axis = 0; axis < 2; ++axis) {
      const int at = 2 * k + axis;
      states[at] = state_.state_of(slots[k]) + axis;
      columns[axis][at] = shift;
      columns[2][at] = wide::multiply(turn, by_turn[axis].raw(), kBits, saturations);
    }
  }
  states[4] = state_.state_of(origin_) + 2;
  columns[3][4] = shift;
}

}  // namespace cairn::detail
