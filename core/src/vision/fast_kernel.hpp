#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "lanes.hpp"

namespace cairn::vision {

inline constexpr int kCircleRadius = 3;

/// Point `K` of the circle (Bresenham, radius 3) around `p`, clockwise from below as OpenCV numbers
/// them; point K + 8 is opposite to point K.
template <int K>
inline const std::uint8_t* circle_point(const std::uint8_t* p, std::ptrdiff_t stride) {
  constexpr int kDx[8] = {0, 1, 2, 3, 3, 3, 2, 1};
  constexpr int kDy[8] = {3, 3, 2, 1, 0, -1, -2, -3};
  constexpr int kSign = K < 8 ? 1 : -1;
  return p + kSign * kDy[K & 7] * stride + kSign * kDx[K & 7];
}

/// Distances between rows, in bytes.
struct RowSteps {
  std::ptrdiff_t one;
  std::ptrdiff_t three;
  std::ptrdiff_t minus_three;

  explicit RowSteps(std::ptrdiff_t stride)
      : one(stride),
        three(keep_in_register(3 * stride)),
        minus_three(keep_in_register(-3 * stride)) {}
};

/// Lanes that pass the antipodal test of all eight pairs, nonzero in the polarity they pass in.
template <class Lanes>
struct Survivors {
  typename Lanes::Pixels bright;
  typename Lanes::Pixels dark;
};

/// What is left of the corner test after some antipodal pairs. Nine contiguous circle points hold
/// at least one point of every pair, so all nine can be brighter than the centre + t only if the
/// brighter point of each pair is: the least of the pairs' maxima bounds the arc from above, and
/// the largest of their minima bounds a dark arc from below. They also hold both points of one
/// pair, so after all eight pairs the largest minimum bounds a bright arc too, and the least
/// maximum a dark one. That refuses straight edges, on whose bright side eight points lie.
template <class Lanes>
class AntipodalFilter {
 public:
  using Pixels = typename Lanes::Pixels;

  AntipodalFilter(Pixels centre, Pixels threshold, Pixels a, Pixels b)
      : bright_limit_(Lanes::add_saturated(centre, threshold)),
        dark_limit_(Lanes::subtract_saturated(centre, threshold)) {
    Lanes::sort(a, b, least_maximum_, largest_minimum_);
  }
  /// Opposite points of the circle.
  void add_pair(const std::uint8_t* a, const std::uint8_t* b) {
    Pixels high;
    Pixels low;
    Lanes::sort(Lanes::load(a), Lanes::load(b), high, low);
    least_maximum_ = Lanes::min(least_maximum_, high);
    largest_minimum_ = Lanes::max(largest_minimum_, low);
  }
  /// No lane can hold a corner, whatever the remaining pairs are.
  bool rejects() const {
    return Lanes::none(Lanes::either(Lanes::subtract_saturated(least_maximum_, bright_limit_),
                                     Lanes::subtract_saturated(dark_limit_, largest_minimum_)));
  }
  /// After all eight pairs.
  Survivors<Lanes> survivors() const {
    Pixels high;
    Pixels low;
    Lanes::sort(least_maximum_, largest_minimum_, high, low);
    return {Lanes::subtract_saturated(low, bright_limit_),
            Lanes::subtract_saturated(dark_limit_, high)};
  }

 private:
  Pixels bright_limit_;
  Pixels dark_limit_;
  Pixels least_maximum_;
  Pixels largest_minimum_;
};

template <class Lanes, int... K>
inline void load_circle(const std::uint8_t* p, std::ptrdiff_t stride,
                        typename Lanes::Pixels* points, std::integer_sequence<int, K...>) {
  ((points[K] = Lanes::load(circle_point<K>(p, stride))), ...);
}

/// Nearer and farther from the arc's own side: an arc counts by the point of it that lies nearest
/// to the centre, and of all arcs the one whose nearest point lies farthest.
template <class Lanes, bool kDark>
struct Polarity {
  using Pixels = typename Lanes::Pixels;
  static Pixels nearer(Pixels a, Pixels b) { return kDark ? Lanes::max(a, b) : Lanes::min(a, b); }
  static Pixels farther(Pixels a, Pixels b) { return kDark ? Lanes::min(a, b) : Lanes::max(a, b); }
};

/// By how much the best of the 16 arcs of nine points lies above the centre (below it), lane by
/// lane; zero where none does. Two arcs that start at neighbouring points share eight: both at once
/// are nearer(those eight, farther(the two others)).
template <class Lanes, bool kDark>
typename Lanes::Pixels arc_contrast(const std::uint8_t* p, std::ptrdiff_t stride) {
  using Pixels = typename Lanes::Pixels;
  using Side = Polarity<Lanes, kDark>;
  Pixels points[16];
  load_circle<Lanes>(p, stride, points, std::make_integer_sequence<int, 16>());
  Pixels run2[8];  // from the odd points on
  Pixels run4[8];
  for (int k = 0; k < 8; ++k) {
    run2[k] = Side::nearer(points[2 * k + 1], points[(2 * k + 2) & 15]);
  }
  for (int k = 0; k < 8; ++k) run4[k] = Side::nearer(run2[k], run2[(k + 1) & 7]);
  Pixels best = Lanes::load(p);
  const Pixels centre = best;
  for (int k = 0; k < 8; ++k) {
    const Pixels run8 = Side::nearer(run4[k], run4[(k + 2) & 7]);
    const Pixels ends = Side::farther(points[2 * k], points[(2 * k + 9) & 15]);
    best = Side::farther(best, Side::nearer(run8, ends));
  }
  return kDark ? Lanes::subtract_saturated(centre, best) : Lanes::subtract_saturated(best, centre);
}

/// One row of scores and the corners in it as a bit per column. Score columns -1 and `width` exist
/// and are zero.
struct ScoreRow {
  std::uint8_t* scores;
  std::uint32_t* corner_bits;

  void set(int x, int score) {
    scores[x] = static_cast<std::uint8_t>(score);
    corner_bits[x >> 5] |= 1U << (static_cast<unsigned>(x) & 31U);
  }
  /// Corners of the columns from x on, a bit each; at most 32 of them.
  void add_corners(int x, std::uint32_t bits) {
    const auto shift = static_cast<unsigned>(x) & 31U;
    const std::uint64_t wide = static_cast<std::uint64_t>(bits) << shift;
    corner_bits[x >> 5] |= static_cast<std::uint32_t>(wide);
    const auto beyond = static_cast<std::uint32_t>(wide >> 32U);
    if (beyond != 0) corner_bits[(x >> 5) + 1] |= beyond;
  }
};

/// Scores of every corner among the kCount pixels at `p`, which are columns x.. of `row`.
template <class Lanes>
struct BlockScorer {
  static void score(const std::uint8_t* p, std::ptrdiff_t stride, int threshold,
                    const Survivors<Lanes>& survivors, int x, ScoreRow row) {
    using Pixels = typename Lanes::Pixels;
    // Score + 1.
    Pixels plus_one = Lanes::splat(0);
    if (!Lanes::none(survivors.bright)) plus_one = arc_contrast<Lanes, false>(p, stride);
    if (!Lanes::none(survivors.dark)) {
      plus_one = Lanes::max(plus_one, arc_contrast<Lanes, true>(p, stride));
    }
    const Pixels above = Lanes::subtract_saturated(plus_one, Lanes::splat(threshold));
    const std::uint32_t corners = Lanes::nonzero_mask(above);
    if (corners == 0) return;
    // Back from the excess over the threshold, zero where there is none.
    const Pixels score = Lanes::add_saturated(above, Lanes::splat(threshold - 1));
    Lanes::store(row.scores + x, Lanes::where_nonzero(above, score));
    row.add_corners(x, corners);
  }
};

/// Four lanes are too few to carry 16 arcs each: few of them survive the filter. The circle of one
/// surviving pixel at a time is spread over four words instead, and its 16 arcs run in the lanes.
template <>
struct BlockScorer<WordLanes> {
  /// The circle of one pixel, four points to a word. Three points lie side by side in the outermost
  /// rows: one load each.
  struct Ring {
    std::uint32_t w0;
    std::uint32_t w1;
    std::uint32_t w2;
    std::uint32_t w3;
  };
  static Ring gather(const std::uint8_t* p, std::ptrdiff_t stride) {
    const auto bytes = [](std::uint32_t b0, std::uint32_t b1, std::uint32_t b2, std::uint32_t b3) {
      return b0 | b1 << 8U | b2 << 16U | b3 << 24U;
    };
    const std::uint8_t* const below2 = keep_in_register(p + 2 * stride);
    const std::uint8_t* const above2 = keep_in_register(p - 2 * stride);
    const std::uint8_t* const below1 = keep_in_register(p + stride);
    const std::uint8_t* const above1 = keep_in_register(p - stride);
    // Bytes 0 to 2: points 15, 0, 1 and 7, 8, 9. The words end at the pixel column that the
    // rightmost point of the circle reaches.
    const std::uint32_t below3 = WordLanes::load(below2 + stride - 1);
    const std::uint32_t above3 = __builtin_bswap32(WordLanes::load(above2 - stride - 1)) >> 8U;
    return {(below3 >> 8U & 0xFFFFU) | bytes(0, 0, below2[2], below1[3]),
            bytes(p[3], above1[3], above2[2], above3),
            (above3 >> 8U & 0xFFFFU) | bytes(0, 0, above2[-2], above1[-3]),
            bytes(p[-3], below1[-3], below2[-2], below3)};
  }
  /// Points k + 1 and k + 2 of the four points k in `a`, where `b` holds the next four.
  static std::uint32_t shift1(std::uint32_t a, std::uint32_t b) { return a >> 8U | b << 24U; }
  static std::uint32_t shift2(std::uint32_t a, std::uint32_t b) { return a >> 16U | b << 16U; }

  /// Largest over the 16 arcs of the least of their nine points.
  static int largest_arc_minimum(std::uint32_t w0, std::uint32_t w1, std::uint32_t w2,
                                 std::uint32_t w3) {
    const std::uint32_t a0 = min_u8x4(w0, shift1(w0, w1));
    const std::uint32_t a1 = min_u8x4(w1, shift1(w1, w2));
    const std::uint32_t a2 = min_u8x4(w2, shift1(w2, w3));
    const std::uint32_t a3 = min_u8x4(w3, shift1(w3, w0));
    const std::uint32_t b0 = min_u8x4(a0, shift2(a0, a1));
    const std::uint32_t b1 = min_u8x4(a1, shift2(a1, a2));
    const std::uint32_t b2 = min_u8x4(a2, shift2(a2, a3));
    const std::uint32_t b3 = min_u8x4(a3, shift2(a3, a0));
    const std::uint32_t c0 = min_u8x4(min_u8x4(b0, b1), w2);
    const std::uint32_t c1 = min_u8x4(min_u8x4(b1, b2), w3);
    const std::uint32_t c2 = min_u8x4(min_u8x4(b2, b3), w0);
    const std::uint32_t c3 = min_u8x4(min_u8x4(b3, b0), w1);
    std::uint32_t best = max_u8x4(max_u8x4(c0, c1), max_u8x4(c2, c3));
    best = max_u8x4(best, best >> 16U);
    best = max_u8x4(best, best >> 8U);
    return static_cast<int>(best & 0xFFU);
  }

  __attribute__((noinline)) static void score(const std::uint8_t* p, std::ptrdiff_t stride,
                                              int threshold, const Survivors<WordLanes>& survivors,
                                              int x, ScoreRow row) {
    std::uint32_t left = survivors.bright | survivors.dark;
    do {
      const auto shift = static_cast<unsigned>(__builtin_ctz(left)) & 24U;
      left &= ~(0xFFU << shift);
      const int lane = static_cast<int>(shift >> 3U);
      const int centre = p[lane];
      const Ring ring = gather(p + lane, stride);
      // Dark arcs are bright ones of the negative.
      std::uint32_t negative = (survivors.bright >> shift & 0xFFU) != 0 ? 0U : ~0U;
      while (true) {
        const int best = largest_arc_minimum(ring.w0 ^ negative, ring.w1 ^ negative,
                                             ring.w2 ^ negative, ring.w3 ^ negative) -
                         (centre ^ static_cast<int>(negative & 0xFFU));
        if (best > threshold) {
          row.set(x + lane, best - 1);
          break;
        }
        if (negative != 0 || (survivors.dark >> shift & 0xFFU) == 0) break;
        negative = ~0U;
      }
    } while (left != 0);
  }
};

/// False when no lane survives.
template <class Lanes>
__attribute__((always_inline)) inline bool find_survivors(const std::uint8_t* p,
                                                          const RowSteps& steps,
                                                          typename Lanes::Pixels threshold,
                                                          Survivors<Lanes>& survivors) {
  AntipodalFilter<Lanes> filter(Lanes::load(p), threshold, Lanes::load(p + 3), Lanes::load(p - 3));
  // Pairs far apart on the circle first: they reject most. Many lanes rarely agree on one pair, and
  // what a branch saves then is less than what its misprediction costs.
  constexpr bool kTestOften = Lanes::kCount < 16;
  if (kTestOften && filter.rejects()) return false;
  filter.add_pair(p + steps.three, p + steps.minus_three);
  if (filter.rejects()) return false;
  // Most blocks end here: no address of what follows is to be computed above.
  p = keep_in_register(p);
  const std::uint8_t* const below2 = keep_in_register(p + 2 * steps.one);
  const std::uint8_t* const above2 = keep_in_register(p - 2 * steps.one);
  filter.add_pair(below2 + 2, above2 - 2);
  filter.add_pair(above2 + 2, below2 - 2);
  if (kTestOften && filter.rejects()) return false;
  const std::uint8_t* const below3 = keep_in_register(p + steps.three);
  const std::uint8_t* const above3 = keep_in_register(p + steps.minus_three);
  const std::uint8_t* const below1 = keep_in_register(p + steps.one);
  const std::uint8_t* const above1 = keep_in_register(p - steps.one);
  filter.add_pair(below3 + 1, above3 - 1);
  filter.add_pair(below1 + 3, above1 - 3);
  if (kTestOften && filter.rejects()) return false;
  filter.add_pair(above1 + 3, below1 - 3);
  filter.add_pair(above3 + 1, below3 - 1);
  survivors = filter.survivors();
  return !Lanes::none(Lanes::either(survivors.bright, survivors.dark));
}

/// Corners and scores of `count` >= kCount pixels from `first` on. The last block is moved back to
/// end at the last pixel; what it sees twice it scores twice the same.
template <class Lanes>
void scan_row(const std::uint8_t* first, std::ptrdiff_t stride, int count, int threshold,
              ScoreRow row) {
  const auto limit = Lanes::splat(threshold);
  const RowSteps steps(stride);
  const std::uint8_t* const last = first + count - Lanes::kCount;
  const std::uint8_t* p = first;
  while (true) {
    Survivors<Lanes> survivors;
    if (find_survivors<Lanes>(p, steps, limit, survivors)) {
      BlockScorer<Lanes>::score(p, stride, threshold, survivors, static_cast<int>(p - first), row);
    }
    p += Lanes::kCount;
    if (p <= last) continue;
    if (p == last + Lanes::kCount) return;
    p = last;
  }
}

/// Same for 1 <= count < kCount pixels, whose circles may end at the last byte of the image: they
/// are copied to where a whole block can be read.
template <class Lanes>
void scan_short_row(const std::uint8_t* first, std::ptrdiff_t stride, int count, int threshold,
                    ScoreRow row) {
  constexpr int kSide = 2 * kCircleRadius + 1;
  constexpr int kPitch = Lanes::kCount + 2 * kCircleRadius;
  std::uint8_t window[kSide * kPitch] = {};
  for (int y = 0; y < kSide; ++y) {
    std::memcpy(window + y * kPitch, first + (y - kCircleRadius) * stride - kCircleRadius,
                static_cast<std::size_t>(count) + 2U * kCircleRadius);
  }
  std::uint8_t scores[Lanes::kCount] = {};
  std::uint32_t bits = 0;
  scan_row<Lanes>(window + kCircleRadius * kPitch + kCircleRadius, kPitch, Lanes::kCount, threshold,
                  {scores, &bits});
  std::memcpy(row.scores, scores, static_cast<std::size_t>(count));
  row.corner_bits[0] = bits & ((1U << static_cast<unsigned>(count)) - 1U);
}

}  // namespace cairn::vision
