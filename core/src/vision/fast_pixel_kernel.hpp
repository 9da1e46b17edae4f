#pragma once

#include "fast_kernel.hpp"

// The corner test of cores that take one pixel at a time.

namespace cairn::vision {

/// The circle of one pixel, as values above a limit count: every second point first, of which an
/// arc of nine holds four in a row.
class PixelRing {
 public:
  /// `negative`: 0 for bright arcs; 255 for dark ones, which are bright ones of the negative.
  PixelRing(const std::uint8_t* p, std::ptrdiff_t stride, std::uint32_t limit,
            std::uint32_t negative)
      : p_(p), stride_(stride), limit_(limit), negative_(negative) {}

  /// Whether some arc of nine points is above the limit.
  bool holds_arc() {
    const std::uint32_t even = twice(above<0>(Half()));
    const std::uint32_t four_even = runs_of_four(even);
    if ((four_even & kHalfMask) == 0) return false;
    const std::uint32_t odd = twice(above<1>(Half()));
    const std::uint32_t four_odd = runs_of_four(odd);
    even_starts_ = four_even & even >> 4U & four_odd & kHalfMask;
    odd_starts_ = four_odd & odd >> 4U & four_even >> 1U & kHalfMask;
    return (even_starts_ | odd_starts_) != 0;
  }
  /// The largest of such arcs' least points. Two that start at neighbouring points share eight.
  std::uint32_t largest_arc_minimum() const {
    std::uint8_t ring[kPoints + kHalf];  // the first ones again at the end
    store(ring, std::make_integer_sequence<int, kPoints>());
    std::uint32_t best = 0;
    for (std::uint32_t left = even_starts_ | odd_starts_; left != 0; left &= left - 1U) {
      const auto k = static_cast<unsigned>(__builtin_ctz(left));
      const std::uint8_t* const points = ring + 2 * k;
      std::uint32_t least = 0;
      if ((even_starts_ >> k & 1U) != 0) least = points[0];
      if ((odd_starts_ >> k & 1U) != 0) least = greater(least, points[9]);
      for (int i = 1; i <= kHalf; ++i) least = lesser(least, points[i]);
      best = greater(best, least);
    }
    return best;
  }

 private:
  static constexpr int kPoints = 16;
  static constexpr int kHalf = 8;
  static constexpr std::uint32_t kHalfMask = 0xFF;
  using Half = std::make_integer_sequence<int, kHalf>;

  static std::uint32_t lesser(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }
  static std::uint32_t greater(std::uint32_t a, std::uint32_t b) { return a > b ? a : b; }
  static std::uint32_t twice(std::uint32_t half) { return half | half << 8U; }
  static std::uint32_t runs_of_four(std::uint32_t bits) {
    bits &= bits >> 1U;
    return bits & bits >> 2U;
  }

  template <int K>
  std::uint32_t point() const {
    return *circle_point<K>(p_, stride_) ^ negative_;
  }
  /// Points First, First + 2, ..., a bit each.
  template <int First, int... K>
  __attribute__((always_inline)) std::uint32_t above(
      std::integer_sequence<int, K...> /*order*/) const {
    std::uint32_t bits = 0;
    ((append_comparison(bits, point<2 * (kHalf - 1 - K) + First>(), limit_)), ...);
    return bits;
  }
  template <int... K>
  __attribute__((always_inline)) void store(std::uint8_t* ring,
                                            std::integer_sequence<int, K...> /*order*/) const {
    ((ring[K] = static_cast<std::uint8_t>(point<K>())), ...);
    std::memcpy(ring + kPoints, ring, kHalf);
  }

  const std::uint8_t* p_;
  std::ptrdiff_t stride_;
  std::uint32_t limit_;
  std::uint32_t negative_;
  std::uint32_t even_starts_ = 0;  ///< of arcs, the points 0, 2, ...
  std::uint32_t odd_starts_ = 0;   ///< and 1, 3, ...
};

/// Scores a pixel whose circle may hold an arc of one polarity.
__attribute__((noinline)) inline bool score_pixel(const std::uint8_t* p, std::ptrdiff_t stride,
                                                  int threshold, std::uint32_t negative, int x,
                                                  ScoreRow row) {
  const std::uint32_t centre = *p ^ negative;
  const std::uint32_t limit = centre + static_cast<std::uint32_t>(threshold) + 1U;
  if (limit > 255U) return false;
  PixelRing ring(p, stride, limit, negative);
  if (!ring.holds_arc()) return false;
  row.set(x, static_cast<int>(ring.largest_arc_minimum() - centre) - 1);
  return true;
}

/// One pixel at a time: most end at two opposite points that are near the centre's value, since
/// nine points in a row hold one of every pair.
template <>
inline void scan_row<PixelLanes>(const std::uint8_t* first, std::ptrdiff_t stride, int count,
                                 int threshold, ScoreRow row) {
  const RowSteps steps(stride);
  const auto band = static_cast<std::uint32_t>(2 * threshold);
  for (int x = 0; x < count; ++x) {
    const std::uint8_t* const p = first + x;
    const auto low = static_cast<std::uint32_t>(*p - threshold);
    const auto high = low + band;
    const auto is_near = [&](std::uint32_t v) { return v - low <= band; };
    const std::uint32_t right = p[3];
    const std::uint32_t left = p[-3];
    if (is_near(right) && is_near(left)) continue;
    const std::uint32_t below = p[steps.three];
    const std::uint32_t above = p[steps.minus_three];
    if (is_near(below) && is_near(above)) continue;
    const auto is_above = [&](std::uint32_t v) {
      return static_cast<std::int32_t>(v) > static_cast<std::int32_t>(high);
    };
    const auto is_below = [&](std::uint32_t v) {
      return static_cast<std::int32_t>(v) < static_cast<std::int32_t>(low);
    };
    if ((is_above(right) || is_above(left)) && (is_above(below) || is_above(above)) &&
        score_pixel(p, stride, threshold, 0, x, row)) {
      continue;
    }
    if ((is_below(right) || is_below(left)) && (is_below(below) || is_below(above))) {
      static_cast<void>(score_pixel(p, stride, threshold, 255, x, row));
    }
  }
}

}  // namespace cairn::vision
