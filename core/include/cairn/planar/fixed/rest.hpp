#pragma once

#include "cairn/base/hash.hpp"
#include "cairn/planar/fixed/types.hpp"

namespace cairn::detail {

/// A vehicle at rest, as Rest: the noise of increments of exactly no motion is held back.
class FixedRest {
 public:
  /// Forgets the rest; what is usual stays.
  void clear() {
    const std::int64_t usual = usual_;
    *this = FixedRest();
    usual_ = usual;
  }
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
  /// Holds the time in which the body may tilt; false where the vehicle does not rest.
  bool hold_time(FixedOffset dt_s) {
    std::uint32_t none = 0;
    if (resting_) held_s_ = add(held_s_, dt_s, none);
    return resting_;
  }
  FixedOffset held_s() const { return held_s_; }

  /// An update of a moving vehicle: its normalised innovations, summed over `rows`, with 32
  /// fraction bits.
  void note_moving(std::int64_t nis, int rows) {
    if (rows == 0) return;
    std::uint32_t none = 0;
    usual_ = wide::add(usual_, (nis / rows - usual_) / kUpdates, none);
  }
  /// Whether innovations agree with rest, as Rest::agrees(). `sum` over `rows`.
  bool agrees(std::int64_t sum, int rows, FixedScore sigmas) const {
    constexpr int kBits = FixedScore::kFractionBits;
    constexpr std::int64_t kOne = std::int64_t{1} << kUsualBits;
    std::uint32_t none = 0;
    const FixedRoot spread = square_root(2 * rows, 0);
    const std::int64_t allowed =
        wide::add(std::int64_t{rows} << kBits,
                  wide::multiply(sigmas.raw(), spread.mantissa, spread.bits, none), none);
    const bool usual = usual_ >= kOne / kTimesUsual;
    return sum <=
           (usual ? allowed : wide::multiply(allowed, kTimesUsual * usual_, kUsualBits, none));
  }
  void hash(Hash64& hash) const {
    hash.add(static_cast<std::uint8_t>(resting_));
    hash.add(held_.distance_variance.raw());
    hash.add(held_.turn_variance.raw());
    hash.add(held_s_.raw());
    hash.add(usual_);
  }

  bool holds_noise() const {
    return held_.distance_variance.raw() > 0 || held_.turn_variance.raw() > 0;
  }
  const FixedIncrement& held() const { return held_; }

 private:
  static constexpr FixedVariance kMostDistance = FixedVariance::nearest(4e-4);  ///< m^2
  static constexpr FixedVariance kMostTurn = FixedVariance::nearest(1e-4);      ///< rad^2

  static constexpr int kUsualBits = FixedCoordinate::kFractionBits;
  static constexpr int kUpdates = 10;
  static constexpr int kTimesUsual = 4;

  bool resting_ = false;
  FixedIncrement held_;
  FixedOffset held_s_;
  /// Innovation per row of a moving vehicle, low-passed.
  std::int64_t usual_ = std::int64_t{1} << kUsualBits;
};

}  // namespace cairn::detail
