#pragma once

#include "cairn/planar/fixed/types.hpp"

namespace cairn::detail {

/// A vehicle at rest, as Rest: the noise of increments of exactly no motion is held back.
class FixedRest {
 public:
  void clear() { *this = FixedRest(); }
  bool resting() const { return resting_; }

  /// An update settled the pose here.
  void begin() {
    clear();
    resting_ = true;
  }
  /// Whether an increment is held. False: it moves the vehicle, or what is held grew too large.
  bool hold(const FixedIncrement& increment) {
    if (!resting_ || increment.distance.raw() != 0 || increment.turn.raw() != 0) return false;
    std::uint32_t none = 0;
    FixedIncrement sum = held_;
    sum.distance_variance = add(sum.distance_variance, increment.distance_variance, none);
    sum.distance_turn = add(sum.distance_turn, increment.distance_turn, none);
    sum.turn_variance = add(sum.turn_variance, increment.turn_variance, none);
    if (sum.distance_variance > kMostDistance || sum.turn_variance > kMostTurn) return false;
    held_ = sum;
    return true;
  }
  bool holds_noise() const {
    return held_.distance_variance.raw() > 0 || held_.turn_variance.raw() > 0;
  }
  const FixedIncrement& held() const { return held_; }

 private:
  static constexpr FixedVariance kMostDistance = FixedVariance::nearest(4e-4);  ///< m^2
  static constexpr FixedVariance kMostTurn = FixedVariance::nearest(1e-4);      ///< rad^2

  bool resting_ = false;
  FixedIncrement held_;
};

}  // namespace cairn::detail
