#pragma once

#include "cairn/numeric/wide_integer.hpp"

namespace cairn {

/// Covariance of up to `Capacity` states without floating point: 32-bit mantissas, one power of two
/// for each state. P(i, j) is mantissa(i, j) 2^-(scale(i) + scale(j)); a variance's mantissa lies
/// in [2^26, 2^30), or is 0: a state that is known or not in use. So each deviation has 28 bits or
/// more, whatever its unit and size.
template <int Capacity>
class ScaledCovariance {
 public:
  static constexpr std::int32_t kMost = std::int32_t{1} << 30;
  /// Of the vectors of downdate(): v_i is a_i 2^-(scale(i) + kVectorBits).
  static constexpr int kVectorBits = 15;

  std::int32_t mantissa(int i, int j) const { return data_[index(i, j)]; }
  std::int32_t variance(int i) const { return data_[index(i, i)]; }
  int scale(int i) const { return scales_[i]; }

  void clear() {
    for (std::int32_t& mantissa : data_) mantissa = 0;
    for (std::int16_t& scale : scales_) scale = 0;
  }
  /// The variance of a state, and its covariances with all others, become 0.
  void clear_state(int i) {
    for (int j = 0; j < Capacity; ++j) at(i, j) = 0;
    scales_[i] = 0;
  }
  /// Makes state `to` the same quantity as state `from`.
  void copy_state(int from, int to) {
    if (from == to) return;
    for (int j = 0; j < Capacity; ++j) {
      if (j != to) at(to, j) = at(from, j);
    }
    at(to, to) = at(from, from);
    scales_[to] = scales_[from];
  }
  /// Makes a state independent of all others, its variance value / 2^bits. Domain: value > 0,
  /// |bits| <= 1000.
  void set_variance(int i, std::int64_t value, int bits) {
    clear_state(i);
    const int length = wide::bit_length(static_cast<std::uint64_t>(value));
    const int twice = (bits + kVarianceBits - length) & ~1;
    std::uint32_t none = 0;
    at(i, i) = static_cast<std::int32_t>(wide::scale(value, twice - bits, none));
    // Rounding up may have made it 2^30.
    if (at(i, i) == kMost) --at(i, i);
    scales_[i] = static_cast<std::int16_t>(twice / 2);
  }
  /// Adds value / 2^bits, independent noise, to a state's variance. Domain: as set_variance(), or
  /// value 0.
  void add_variance(int i, std::int64_t value, int bits, std::uint32_t& saturations) {
    if (value <= 0) return;
    if (variance(i) == 0) return set_variance(i, value, bits);
    const std::int64_t added = wide::scale(value, 2 * scales_[i] - bits, saturations);
    const std::int64_t sum = wide::add(variance(i), added, saturations);
    const int length = wide::bit_length(static_cast<std::uint64_t>(sum));
    const int halvings = length > kVarianceBits ? (length - kVarianceBits + 1) / 2 : 0;
    if (halvings > 0) {
      for (int j = 0; j < Capacity; ++j) {
        if (j != i) at(i, j) = shift_down(at(i, j), halvings);
      }
      scales_[i] = static_cast<std::int16_t>(scales_[i] - halvings);
    }
    at(i, i) = at_most(wide::round_shift(sum, 2 * halvings));
  }

  /// Whether a state keeps a variance of 0 or more when downdate() takes a^2 + b^2 from it.
  bool leaves_variance(int i, std::int32_t a, std::int32_t b) const {
    return std::int64_t{a} * a + std::int64_t{b} * b <= std::int64_t{variance(i)} * kMost;
  }
  /// The states whose variance is not 0, ascending; returns how many.
  int active(std::uint8_t* states) const {
    int count = 0;
    for (int i = 0; i < Capacity; ++i) {
      if (variance(i) != 0) states[count++] = static_cast<std::uint8_t>(i);
    }
    return count;
  }

  /// P -= a a^T + b b^T over the states listed, ascending; `a` and `b` as the list, in the scale
  /// kVectorBits. Domain: leaves_variance(). What rounding would take below 0 stays a unit above
  /// it. Cost: two multiply-adds an element.
  void downdate(const std::uint8_t* states, int count, const std::int32_t* a,
                const std::int32_t* b) {
    constexpr std::int64_t kHalf = std::int64_t{1} << (2 * kVectorBits - 1);
    for (int p = 0; p < count; ++p) {
      std::int32_t* row = data_ + states[p] * (states[p] + 1) / 2;
      const std::int32_t ap = a[p];
      const std::int32_t bp = b[p];
      for (int q = 0; q < p; ++q) {
        const std::int64_t sum = kHalf + std::int64_t{ap} * a[q] + std::int64_t{bp} * b[q];
        std::int32_t& element = row[states[q]];
        element = limited(element - static_cast<std::int32_t>(sum >> (2 * kVectorBits)));
      }
      const std::int64_t sum = kHalf + std::int64_t{ap} * ap + std::int64_t{bp} * bp;
      const std::int64_t left = variance(states[p]) - (sum >> (2 * kVectorBits));
      at(states[p], states[p]) = left > 0 ? static_cast<std::int32_t>(left) : 1;
    }
    for (int p = 0; p < count; ++p) refine(states[p]);
  }

 private:
  static constexpr int kVarianceBits = 30;
  static constexpr std::int32_t kLeast = std::int32_t{1} << 26;

  static constexpr int index(int i, int j) {
    return i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i;
  }
  std::int32_t& at(int i, int j) { return data_[index(i, j)]; }

  static std::int32_t limited(std::int32_t mantissa) {
    return mantissa >= kMost ? kMost - 1 : mantissa < -kMost ? -kMost : mantissa;
  }
  static std::int32_t at_most(std::int64_t mantissa) {
    return mantissa >= kMost ? kMost - 1 : static_cast<std::int32_t>(mantissa);
  }
  static std::int32_t shift_down(std::int32_t mantissa, int shift) {
    return shift > 31 ? 0 : static_cast<std::int32_t>(wide::round_shift(mantissa, shift));
  }

  /// Brings a variance that has become small to the upper end of its range.
  void refine(int i) {
    if (variance(i) >= kLeast) return;
    const int length = wide::bit_length(static_cast<std::uint64_t>(variance(i)));
    const int doublings = (kVarianceBits - length) / 2;
    for (int j = 0; j < Capacity; ++j) {
      if (j == i) continue;
      const std::int64_t grown = std::int64_t{at(i, j)} * (std::int64_t{1} << doublings);
      at(i, j) = grown < -kMost ? -kMost : at_most(grown);
    }
    at(i, i) *= std::int32_t{1} << (2 * doublings);
    scales_[i] = static_cast<std::int16_t>(scales_[i] + doublings);
  }

  std::int32_t data_[Capacity * (Capacity + 1) / 2] = {};
  std::int16_t scales_[Capacity] = {};
};

}  // namespace cairn
