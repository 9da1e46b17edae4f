#pragma once

#include "cairn/geometry/fixed_camera.hpp"
#include "cairn/numeric/scaled_covariance.hpp"

namespace cairn {

/// DepthFilter without floating point. Pixels are divided by the focal lengths: residuals and what
/// they change by rotations are near 1, whatever the lens.
template <int Keyframes, int Seeds>
class FixedDepthFilter {
 public:
  static constexpr int kStates = 2 + 2 * Keyframes + Seeds;

  using Rho = Fixed<std::int64_t, 32>;  ///< 1/m; rad of a rotation's correction
  using Variance = Fixed<std::int64_t, 44>;

  /// As DepthFilter::Correction.
  struct Correction {
    Rho state[kStates];
    Rho camera(int axis) const { return state[axis]; }
    Rho keyframe(int k, int axis) const { return state[2 + 2 * k + axis]; }
    Rho depth(int slot) const { return state[2 + 2 * Keyframes + slot]; }
  };

  /// As DepthFilter::Residual, over the focal lengths.
  struct Residual {
    int slot = 0;
    int keyframe = 0;
    FixedTangent pixel[2];
    FixedTangent by_camera[2][2];
    FixedTangent by_keyframe[2][2];
    FixedLength by_depth[2];
    FixedTangent unmodelled[2];
  };

  /// Covariance of a residual, as xx, xy, yy.
  struct Innovation {
    std::int64_t xx = 0;
    std::int64_t xy = 0;
    std::int64_t yy = 0;
    int bits[2] = {};  ///< S(r, s) is its number 2^(32 - bits[r] - bits[s])
  };

  void clear() { P_.clear(); }

  /// Adds the uncertainty of the camera's rotation since the frame before.
  void predict(FixedAngle sigma_pitch, FixedAngle sigma_yaw) {
    add_square(0, sigma_pitch.raw(), FixedAngle::kFractionBits);
    add_square(1, sigma_yaw.raw(), FixedAngle::kFractionBits);
  }
  /// Makes the current camera keyframe k. Cost: one pass over two rows.
  void begin_keyframe(int k) {
    for (int i = 0; i < 2; ++i) P_.copy_state(i, 2 + 2 * k + i);
  }
  void begin_seed(int slot, Rho sigma) {
    const int state = state_of(slot);
    P_.clear_state(state);
    std::uint32_t none = 0;
    add_square(
        state,
        wide::narrow(wide::scale(sigma.raw(), kSigmaBits - Rho::kFractionBits, none), saturations_),
        kSigmaBits);
  }
  void end_keyframe(int k) {
    for (int i = 0; i < 2; ++i) P_.clear_state(2 + 2 * k + i);
  }
  void end_seed(int slot) { P_.clear_state(state_of(slot)); }
  /// Moves a seed's state from slot `from` to slot `to`, whose own is lost.
  void move_seed(int from, int to) {
    if (from == to) return;
    P_.copy_state(state_of(from), state_of(to));
    P_.clear_state(state_of(from));
  }

  /// Deviation of a seed's inverse depth.
  Rho sigma(int slot) const {
    const int state = state_of(slot);
    const FixedRoot root = square_root(P_.variance(state), 0);
    std::uint32_t none = 0;
    return Rho::from_raw(
        wide::scale(root.mantissa, Rho::kFractionBits - root.bits - P_.scale(state), none));
  }

  /// Of the camera's yaw since keyframe k, rad^2; at least what a difference of the two resolves.
  Variance yaw_variance(int k) const {
    const int now = 1;
    const int then = 3 + 2 * k;
    std::uint32_t none = 0;
    const auto term = [&](int i, int j, int doublings) {
      const int shift = Variance::kFractionBits + doublings - P_.scale(i) - P_.scale(j);
      return wide::scale(P_.mantissa(i, j), shift, none);
    };
    const std::int64_t both = wide::add(term(now, now, 0), term(then, then, 0), none);
    const std::int64_t least = (both >> 28) + 1;
    const std::int64_t difference = wide::add(both, -term(then, now, 1), none);
    return Variance::from_raw(difference > least ? difference : least);
  }

  /// Innovation covariance of a residual; `sigma`: of a pixel over the focal lengths.
  Innovation innovation_covariance(const Residual& residual, const FixedTangent (&sigma)[2]) const {
    return innovation(rows_of(residual, sigma));
  }

  /// As DepthFilter::update(). Cost: two multiply-adds for each element of the covariance in use.
  bool update(const Residual& residual, const FixedTangent (&sigma)[2],
              Fixed<std::int32_t, 16> gate, Correction& correction);

  /// Results that did not fit their format.
  std::uint32_t saturations() const { return saturations_; }

 private:
  static constexpr int kTerms = 5;
  static constexpr int kSigmaBits = 24;
  static constexpr int kWhite = 24;  ///< fraction bits of an innovation in its own deviations
  static constexpr int kVectorBits = ScaledCovariance<kStates>::kVectorBits;

  /// What a residual makes of its states: coefficients at a scale for each row, times that of each
  /// state, below 2^29. A deviation of noise counts as a state of the scale kVectorBits.
  struct Rows {
    int states[kTerms];
    std::int32_t factors[2][kTerms];
    std::int32_t noise[2];
    std::int32_t unmodelled[2];
    int bits[2];
  };

  /// 1 / sqrt(value) = factor 2^(bits - 60).
  struct InverseRoot {
    std::int32_t factor;
    int bits;
    explicit InverseRoot(std::int64_t value) {
      const FixedRoot root = square_root(value, 0);
      bits = root.bits;
      factor = static_cast<std::int32_t>(((std::uint64_t{1} << 60U) - 1U) /
                                         static_cast<std::uint32_t>(root.mantissa));
    }
    /// x / sqrt(value) 2^shift.
    std::int64_t times(std::int64_t x, int shift, std::uint32_t& saturations) const {
      const int down = 60 - bits - shift;
      if (down >= 0) return wide::multiply(x, factor, down < 126 ? down : 126, saturations);
      return wide::scale(wide::multiply(x, factor, 0, saturations), -down, saturations);
    }
  };

  static int state_of(int slot) { return 2 + 2 * Keyframes + slot; }

  void add_square(int state, std::int32_t sigma, int bits) {
    P_.add_variance(state, std::int64_t{sigma} * sigma, 2 * bits, saturations_);
  }

  Rows rows_of(const Residual& residual, const FixedTangent (&sigma)[2]) const;
  Innovation innovation(const Rows& rows) const;
  /// The covariances of a state with the rows, in the scale of both, over 2^32.
  void with_rows(int state, const Rows& rows, std::int32_t& x, std::int32_t& y) const {
    std::int64_t first = std::int64_t{1} << 31;
    std::int64_t second = first;
    for (int k = 0; k < kTerms; ++k) {
      const std::int64_t mantissa = P_.mantissa(state, rows.states[k]);
      first += mantissa * rows.factors[0][k];
      second += mantissa * rows.factors[1][k];
    }
    x = static_cast<std::int32_t>(first >> 32);
    y = static_cast<std::int32_t>(second >> 32);
  }
  /// What is left of a residual's row after the corrections so far.
  std::int64_t left_of(const Residual& residual, int row, const Correction& correction);

  ScaledCovariance<kStates> P_;
  std::uint32_t saturations_ = 0;
};

template <int Keyframes, int Seeds>
auto FixedDepthFilter<Keyframes, Seeds>::rows_of(const Residual& residual,
                                                 const FixedTangent (&sigma)[2]) const -> Rows {
  constexpr int kTangent = FixedTangent::kFractionBits;
  constexpr int kFactorBits = 29;
  Rows rows;
  rows.states[0] = 0;
  rows.states[1] = 1;
  rows.states[2] = 2 + 2 * residual.keyframe;
  rows.states[3] = rows.states[2] + 1;
  rows.states[4] = state_of(residual.slot);
  for (int r = 0; r < 2; ++r) {
    const std::int32_t h[kTerms] = {residual.by_camera[r][0].raw(), residual.by_camera[r][1].raw(),
                                    residual.by_keyframe[r][0].raw(),
                                    residual.by_keyframe[r][1].raw(), residual.by_depth[r].raw()};
    const auto fraction = [](int k) {
      return k < kTerms - 1 ? FixedTangent::kFractionBits : FixedLength::kFractionBits;
    };
    const std::int32_t noise = sigma[r].raw() > 0 ? sigma[r].raw() : 1;
    const std::int32_t unmodelled = residual.unmodelled[r].raw();
    const auto length_of = [](std::int32_t raw) { return wide::bit_length(wide::magnitude(raw)); };
    int longest = length_of(noise | static_cast<std::int32_t>(wide::magnitude(unmodelled)));
    longest -= kTangent + kVectorBits;
    for (int k = 0; k < kTerms; ++k) {
      // Of a state that is known nothing follows, whatever its scale.
      if (h[k] == 0 || P_.variance(rows.states[k]) == 0) continue;
      const int length = length_of(h[k]) - fraction(k) - P_.scale(rows.states[k]);
      longest = length > longest ? length : longest;
    }
    const int bits = kFactorBits - longest;
    std::uint32_t none = 0;
    const auto scaled = [&](std::int32_t raw, int own) {
      return static_cast<std::int32_t>(wide::scale(raw, bits - own, none));
    };
    for (int k = 0; k < kTerms; ++k) {
      const bool known = P_.variance(rows.states[k]) == 0;
      rows.factors[r][k] = known ? 0 : scaled(h[k], fraction(k) + P_.scale(rows.states[k]));
    }
    rows.noise[r] = scaled(noise, kTangent + kVectorBits);
    rows.unmodelled[r] = scaled(unmodelled, kTangent + kVectorBits);
    rows.bits[r] = bits;
  }
  return rows;
}

template <int Keyframes, int Seeds>
auto FixedDepthFilter<Keyframes, Seeds>::innovation(const Rows& rows) const -> Innovation {
  std::int64_t xx = 0;
  std::int64_t xy = 0;
  std::int64_t yy = 0;
  for (int k = 0; k < kTerms; ++k) {
    if ((rows.factors[0][k] | rows.factors[1][k]) == 0) continue;
    std::int32_t x = 0;
    std::int32_t y = 0;
    with_rows(rows.states[k], rows, x, y);
    xx += std::int64_t{rows.factors[0][k]} * x;
    xy += std::int64_t{rows.factors[0][k]} * y;
    yy += std::int64_t{rows.factors[1][k]} * y;
  }
  const auto noise = [&](int r, int s) {
    std::int64_t sum = std::int64_t{rows.unmodelled[r]} * rows.unmodelled[s];
    if (r == s) sum += std::int64_t{rows.noise[r]} * rows.noise[r];
    return wide::round_shift(sum, 2);  // deviations have 2 kVectorBits = 30 bits, S 32
  };
  Innovation out;
  out.xx = xx + noise(0, 0);
  out.xy = xy + noise(0, 1);
  out.yy = yy + noise(1, 1);
  out.bits[0] = rows.bits[0];
  out.bits[1] = rows.bits[1];
  return out;
}

template <int Keyframes, int Seeds>
std::int64_t FixedDepthFilter<Keyframes, Seeds>::left_of(const Residual& residual, int row,
                                                         const Correction& correction) {
  std::int64_t left = residual.pixel[row].raw();
  const auto take = [&](std::int32_t h, int fraction, Rho by) {
    const int shift = fraction + Rho::kFractionBits - FixedTangent::kFractionBits;
    left = wide::add(left, -wide::multiply(h, by.raw(), shift, saturations_), saturations_);
  };
  for (int axis = 0; axis < 2; ++axis) {
    constexpr int kTangent = FixedTangent::kFractionBits;
    take(residual.by_camera[row][axis].raw(), kTangent, correction.camera(axis));
    take(residual.by_keyframe[row][axis].raw(), kTangent,
         correction.keyframe(residual.keyframe, axis));
  }
  take(residual.by_depth[row].raw(), FixedLength::kFractionBits, correction.depth(residual.slot));
  return left;
}

/// The innovation covariance is L L^T; the states' covariances with the innovation over L are the
/// vectors whose squares P loses, and the innovation over L weighs them in the correction.
template <int Keyframes, int Seeds>
bool FixedDepthFilter<Keyframes, Seeds>::update(const Residual& residual,
                                                const FixedTangent (&sigma)[2],
                                                Fixed<std::int32_t, 16> gate,
                                                Correction& correction) {
  constexpr int kTangent = FixedTangent::kFractionBits;
  constexpr std::int64_t kLeast = 1 << 16;  // of a variance in its scale, which makes it near 2^54
  const Rows rows = rows_of(residual, sigma);
  const Innovation s = innovation(rows);
  const InverseRoot first(s.xx < kLeast ? kLeast : s.xx);
  const std::int64_t slope = wide::narrow(first.times(s.xy, 0, saturations_), saturations_);
  // The second row alone has at least its own noise.
  const std::int64_t noise = std::int64_t{rows.noise[1]} * rows.noise[1] / 4;
  const std::int64_t least = noise < kLeast ? kLeast : noise;
  const std::int64_t rest = s.yy - wide::multiply(slope, slope, 0, saturations_);
  const InverseRoot second(rest < least ? least : rest);

  std::uint32_t none = 0;  // what is too large for its format fails the gate
  const auto whitened = [&](const InverseRoot& by, std::int64_t left, int bits) {
    const int shift = bits - 16 + kWhite - kTangent;
    return wide::narrow(by.times(left, shift, none), none);
  };
  const std::int64_t u = left_of(residual, 0, correction);
  const std::int64_t v = left_of(residual, 1, correction);
  const std::int32_t x = whitened(first, u, s.bits[0]);
  const std::int64_t common = wide::scale(slope * x, 16 - s.bits[1] - kWhite + kTangent, none);
  const std::int32_t y = whitened(second, wide::add(v, -common, none), s.bits[1]);
  const std::int64_t distance = std::int64_t{x} * x + std::int64_t{y} * y;
  const std::int64_t most =
      std::int64_t{gate.raw()} * (std::int64_t{1} << (2 * kWhite - gate.kFractionBits));
  if (none != 0 || distance > most) return false;

  std::uint8_t states[kStates];
  std::int32_t a[kStates];
  std::int32_t b[kStates];
  const int count = P_.active(states);
  for (int p = 0; p < count; ++p) {
    const int i = states[p];
    std::int32_t with_x = 0;
    std::int32_t with_y = 0;
    with_rows(i, rows, with_x, with_y);
    const std::int64_t across = std::int64_t{with_x} * first.factor;
    a[p] = wide::narrow(wide::round_shift(across, 29 - first.bits), saturations_);
    const std::int64_t own = std::int64_t{with_y} * (std::int64_t{1} << 31);
    const std::int64_t alone = wide::round_shift(own - slope * a[p], 31 - second.bits);
    b[p] = wide::narrow(wide::multiply(alone, second.factor, 29, saturations_), saturations_);
    // By rounding alone.
    for (int step = 0; step < 4 && !P_.leaves_variance(i, a[p], b[p]); ++step) {
      a[p] -= a[p] / 1024;
      b[p] -= b[p] / 1024;
    }
    if (!P_.leaves_variance(i, a[p], b[p])) {
      a[p] = b[p] = 0;
      ++saturations_;
    }
    const std::int64_t gain = std::int64_t{a[p]} * x + std::int64_t{b[p]} * y;
    std::int64_t change =
        wide::scale(gain, Rho::kFractionBits - P_.scale(i) - kVectorBits - kWhite, saturations_);
    change = wide::add(correction.state[i].raw(), change, saturations_);
    correction.state[i] = Rho::from_raw(change);
  }
  P_.downdate(states, count, a, b);
  return true;
}

}  // namespace cairn
