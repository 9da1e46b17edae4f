#pragma once

#include "cairn/planar/fixed/error.hpp"

// FixedPlanarError: what is read out.

namespace cairn::detail {

template <class State, FixedError Error>
FixedPoseCovariance FixedPlanarError<State, Error>::pose_covariance(const State& state,
                                                                    std::uint32_t& saturations,
                                                                    bool with_shared) const {
  if constexpr (kWorld) {
    const auto of = [&](int i, int k) {
      return FixedVariance::from_raw(factor_.covariance(i, k, saturations));
    };
    FixedMotionNoise taken_in;
    taken_in.start({{of(1, 1), of(2, 1), of(2, 2)}, of(1, 0), of(2, 0), of(0, 0)});
    taken_in.turn(convert<FixedOffset>(moved_[0], saturations),
                  convert<FixedOffset>(moved_[1], saturations), saturations);
    const auto both = [&](FixedVariance a, FixedVariance b) { return add(a, b, saturations); };
    const FixedCovariance2& a = taken_in.position();
    const FixedCovariance2& b = motion_.position();
    return {{both(a.xx, b.xx), both(a.xy, b.xy), both(a.yy, b.yy)},
            both(taken_in.x_heading(), motion_.x_heading()),
            both(taken_in.y_heading(), motion_.y_heading()),
            both(taken_in.heading(), motion_.heading())};
  }
  FixedPoseCovariance sum = motion_.about(state.vehicle(0), state.vehicle(1), saturations);
  const auto enter = [&](FixedVariance& to, FixedVariance shared, int i, int k) {
    const auto own = FixedVariance::from_raw(factor_.covariance(i, k, saturations));
    if (with_shared) to = add(to, shared, saturations);
    to = add(to, own, saturations);
  };
  enter(sum.heading, shared_.heading, 0, 0);
  enter(sum.x_heading, shared_.x_heading, 1, 0);
  enter(sum.y_heading, shared_.y_heading, 2, 0);
  enter(sum.position.xx, shared_.position.xx, 1, 1);
  enter(sum.position.xy, shared_.position.xy, 2, 1);
  enter(sum.position.yy, shared_.position.yy, 2, 2);
  return sum;
}

template <class State, FixedError Error>
FixedPoseCovariance FixedPlanarError<State, Error>::landmark_covariance(const State& state,
                                                                        int slot) const {
  std::uint32_t none = 0;
  const int l = state.state_of(slot);
  FixedMotionNoise turn;
  turn.widen(FixedVariance(), motion_.heading(), none);
  FixedPoseCovariance sum = turn.about(state.landmark(slot, 0), state.landmark(slot, 1), none);
  // What the deferred noise makes of a point is seen by its heading and by the point alone.
  const auto enter = [&](FixedVariance& to, FixedVariance shared, int i, int k) {
    to = add(add(to, shared, none), covariance(i, k), none);
  };
  enter(sum.heading, shared_.heading, 0, 0);
  enter(sum.x_heading, shared_.x_heading, l, 0);
  enter(sum.y_heading, shared_.y_heading, l + 1, 0);
  enter(sum.position.xx, shared_.position.xx, l, l);
  enter(sum.position.xy, shared_.position.xy, l + 1, l);
  enter(sum.position.yy, shared_.position.yy, l + 1, l + 1);
  return sum;
}

template <class State, FixedError Error>
FixedCovariance3 FixedPlanarError<State, Error>::covariance_of(
    const FixedStateRow (&rows)[3]) const {
  constexpr int kBits = 40;
  constexpr int kDown = 2 * kBits - FixedVariance::kFractionBits;
  std::uint32_t none = 0;
  std::int64_t sums[6] = {};
  for (int column = 0; column < factor_.size(); ++column) {
    std::int64_t v[3] = {};
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < rows[i].count; ++k) {
        const int state = rows[i].state[k];
        if (column > state) continue;
        const std::int64_t part = rows[i].coefficient[k] * factor_.at(state, column);
        const int shift = kBits - rows[i].bits[k] - factor_.bits(state);
        v[i] = wide::add(v[i], wide::scale(part, shift, none), none);
      }
    }
    for (int i = 0, at = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j, ++at) {
        sums[at] = wide::add(sums[at], wide::multiply(v[i], v[j], kDown, none), none);
      }
    }
  }
  FixedVariance c[6];
  for (int k = 0; k < 6; ++k) c[k] = FixedVariance::from_raw(sums[k]);
  return {c[0], c[1], c[2], c[3], c[4], c[5]};
}

template <class State, FixedError Error>
FixedCovariance2 FixedPlanarError<State, Error>::relative_covariance(
    const State& state, int slot, std::uint32_t& saturations) const {
  const int l = state.state_of(slot);
  int bits = Factor::kMostBits;
  for (const int row : {1, 2, l, l + 1}) {
    bits = factor_.bits(row) < bits ? factor_.bits(row) : bits;
  }
  --bits;                     // a difference of two
  std::int64_t turn[2] = {};  // the heading's part, in the first column
  if constexpr (kWorld) {
    const FixedLength by[2] = {lever(state, slot, 1), -lever(state, slot, 0)};
    const std::uint64_t larger = wide::magnitude(by[0].raw()) | wide::magnitude(by[1].raw());
    const int fits = factor_.bits(0) + FixedLength::kFractionBits - wide::bit_length(larger) - 1;
    bits = (fits < bits ? fits : bits) - 1;
    for (int axis = 0; axis < 2; ++axis) {
      turn[axis] = wide::scale(std::int64_t{by[axis].raw()} * factor_.at(0, 0),
                               bits - FixedLength::kFractionBits - factor_.bits(0), saturations);
    }
  }
  std::int64_t xx = 0;
  std::int64_t xy = 0;
  std::int64_t yy = 0;
  const auto shift_of = [&](int row) {
    const int shift = factor_.bits(row) - bits;
    return shift < 31 ? shift : 31;
  };
  const int shifts[2] = {shift_of(l), shift_of(l + 1)};
  auto first = factor_.row(l);
  auto second = factor_.row(l + 1);
  for (int j = 0; j <= l + 1; ++j) {
    std::int32_t d[2] = {j <= l ? first.next() >> shifts[0] : 0, second.next() >> shifts[1]};
    if (j <= 2) {  // the vehicle's
      for (int axis = 0; axis < 2; ++axis) {
        if (j <= 1 + axis) d[axis] -= factor_.at(1 + axis, j) >> shift_of(1 + axis);
        if (kWorld && j == 0) d[axis] += static_cast<std::int32_t>(turn[axis]);
      }
    }
    xx += std::int64_t{d[0]} * d[0];
    xy += std::int64_t{d[0]} * d[1];
    yy += std::int64_t{d[1]} * d[1];
  }
  const auto variance = [&](std::int64_t sum) {
    return FixedVariance::from_raw(
        wide::scale(sum, FixedVariance::kFractionBits - 2 * bits, saturations));
  };
  FixedCovariance2 out = {variance(xx), variance(xy), variance(yy)};
  motion_.add_relative(state.relative(slot, 0), state.relative(slot, 1), out, saturations);
  return out;
}

template <class State, FixedError Error>
FixedCovariance2 FixedPlanarError<State, Error>::innovation_covariance(
    const State& state, const FixedPixelSighting& sighting, std::int32_t* scratch,
    std::uint32_t& saturations) const {
  const int last = state.state_of(sighting.slot) + 2;
  std::int32_t* const a[2] = {scratch, scratch + kStates};
  int bits[2];
  for (int i = 0; i < 2; ++i) {
    bits[i] = factor_.product(state.row_of(sighting, i), last, Factor::kMostBits, a[i]);
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
  const FixedCovariance2 waiting = waiting_noise(state, sighting.slot, saturations);
  const auto enter = [&](FixedVariance& to, int i, int j) {
    to = add(to, form(waiting, sighting.h[i], sighting.h[j], saturations), saturations);
  };
  enter(out.xx, 0, 0);
  enter(out.xy, 0, 1);
  enter(out.yy, 1, 1);
  return out;
}

template <class State, FixedError Error>
std::int64_t FixedPlanarError<State, Error>::depth_variance(const State& state, int slot,
                                                            const FixedTangent (&depth)[3],
                                                            std::int32_t* scratch,
                                                            std::uint32_t& saturations) const {
  FixedStateRow row;
  const int l = state.state_of(slot);
  for (int i = 0; i < 3; ++i) {
    if (depth[i].raw() != 0) row.add(l + i, depth[i].raw(), FixedTangent::kFractionBits);
  }
  for (int i = 0; i < 2; ++i) {
    if (depth[i].raw() != 0) row.add(1 + i, -depth[i].raw(), FixedTangent::kFractionBits);
  }
  const int bits = factor_.product(row, l + 2, Factor::kMostBits, scratch);
  std::int64_t squared = 0;
  for (int j = 0; j <= l + 2; ++j) squared += std::int64_t{scratch[j]} * scratch[j];
  const std::int64_t own =
      wide::scale(squared, FixedVariance::kFractionBits - 2 * bits, saturations);
  if (motion_.empty()) return own;
  const FixedCovariance2 waiting = waiting_noise(state, slot, saturations);
  return wide::add(own, form(waiting, depth, depth, saturations).raw(), saturations);
}

}  // namespace cairn::detail
