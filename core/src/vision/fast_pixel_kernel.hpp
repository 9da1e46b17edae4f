#pragma once

#include "fast_kernel.hpp"

// The corner test of cores that take one pixel at a time.

namespace cairn::vision {

/// The circle of one pixel, as values above a limit count.
class PixelRing {
 public:
  /// `negative`: 0 for bright arcs; 255 for dark ones, which are bright ones of the negative.
  PixelRing(const std::uint8_t* p, std::ptrdiff_t stride, std::uint32_t limit,
            std::uint32_t negative) {
    load(p, stride, limit, negative, std::make_integer_sequence<int, kPoints>());
    std::memcpy(points_ + kPoints, points_, kArc);
    const std::uint32_t twice = bits_ | bits_ << static_cast<unsigned>(kPoints);
    std::uint32_t runs = twice & twice >> 1U;
    runs &= runs >> 2U;
    runs &= runs >> 4U;
    starts_ = runs & twice >> 8U & 0xFFFFU;
  }
  /// Whether some arc of nine points is above the limit.
  bool holds_arc() const { return starts_ != 0; }
  /// The largest of such arcs' least points. Two that start at neighbouring points share eight.
  std::uint32_t largest_arc_minimum() const {
    std::uint32_t best = 0;
    for (std::uint32_t starts = starts_; starts != 0;) {
      const int first = __builtin_ctz(starts);
      const std::uint8_t* const points = points_ + first;
      const bool two = (starts >> 1U >> static_cast<unsigned>(first) & 1U) != 0;
      std::uint32_t least = points[0];
      if (two) least = greater(least, points[kArc]);
      least = lesser(least, lesser(points[1], points[2]));
      least = lesser(least, lesser(points[3], points[4]));
      least = lesser(least, lesser(points[5], points[6]));
      least = lesser(least, lesser(points[7], points[8]));
      best = greater(best, least);
      starts &= starts - 1U;
      if (two) starts &= starts - 1U;
    }
    return best;
  }

 private:
  static constexpr int kPoints = 16;
  static constexpr int kArc = 9;

  static std::uint32_t lesser(std::uint32_t a, std::uint32_t b) { return a < b ? a : b; }
  static std::uint32_t greater(std::uint32_t a, std::uint32_t b) { return a > b ? a : b; }

  template <int... K>
  __attribute__((always_inline)) void load(const std::uint8_t* p, std::ptrdiff_t stride,
                                           std::uint32_t limit, std::uint32_t negative,
                                           std::integer_sequence<int, K...>) {
    ((append<kPoints - 1 - K>(p, stride, limit, negative)), ...);
  }
  template <int K>
  __attribute__((always_inline)) void append(const std::uint8_t* p, std::ptrdiff_t stride,
                                             std::uint32_t limit, std::uint32_t negative) {
    const std::uint32_t point = *circle_point<K>(p, stride) ^ negative;
    points_[K] = static_cast<std::uint8_t>(point);
    append_comparison(bits_, point, limit);
  }

  std::uint8_t points_[kPoints + kArc];  ///< the first ones again at the end
  std::uint32_t bits_ = 0;               ///< of the points above the limit
  std::uint32_t starts_ = 0;
};

/// Scores a pixel whose circle may hold an arc of one polarity.
__attribute__((noinline)) inline bool score_pixel(const std::uint8_t* p, std::ptrdiff_t stride,
                                                  int threshold, std::uint32_t negative, int x,
                                                  ScoreRow row) {
  const std::uint32_t centre = *p ^ negative;
  const std::uint32_t limit = centre + static_cast<std::uint32_t>(threshold) + 1U;
  if (limit > 255U) return false;
  const PixelRing ring(p, stride, limit, negative);
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
