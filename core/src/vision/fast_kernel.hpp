#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "lanes.hpp"

namespace cairn::vision {

inline constexpr int kCircleRadius = 3;

/// Offsets of the 16 circle points (Bresenham, radius 3) in one image, clockwise from below as
/// OpenCV numbers them; point k + 8 is opposite to point k.
struct Circle {
  std::ptrdiff_t offset[16];

  explicit Circle(std::ptrdiff_t stride) {
    constexpr int kDx[8] = {0, 1, 2, 3, 3, 3, 2, 1};
    constexpr int kDy[8] = {3, 3, 2, 1, 0, -1, -2, -3};
    for (int k = 0; k < 8; ++k) {
      offset[k] = kDy[k] * stride + kDx[k];
      offset[k + 8] = -offset[k];
    }
  }
};

/// What is left of the corner test after some antipodal pairs. Nine contiguous circle points hold
/// at least one point of every pair, so all nine can be brighter than the centre + t only if the
/// brighter point of each pair is: the least of the pairs' maxima bounds the arc from above, and
/// the largest of their minima bounds a dark arc from below.
template <class Lanes>
class AntipodalFilter {
 public:
  using Pixels = typename Lanes::Pixels;

  AntipodalFilter(Pixels centre, Pixels threshold, Pixels a, Pixels b)
      : bright_limit_(Lanes::add_saturated(centre, threshold)),
        dark_limit_(Lanes::subtract_saturated(centre, threshold)) {
    Lanes::sort(a, b, least_maximum_, largest_minimum_);
  }
  void add_pair(Pixels a, Pixels b) {
    Pixels high;
    Pixels low;
    Lanes::sort(a, b, high, low);
    least_maximum_ = Lanes::min(least_maximum_, high);
    largest_minimum_ = Lanes::max(largest_minimum_, low);
  }
  /// Nonzero in lanes that may still hold a bright (dark) corner.
  Pixels bright() const { return Lanes::subtract_saturated(least_maximum_, bright_limit_); }
  Pixels dark() const { return Lanes::subtract_saturated(dark_limit_, largest_minimum_); }
  bool rejects() const { return Lanes::none(Lanes::either(bright(), dark())); }

 private:
  Pixels bright_limit_;
  Pixels dark_limit_;
  Pixels least_maximum_;
  Pixels largest_minimum_;
};

/// Score + 1 of every lane (0 where it is not a corner at any threshold): the largest over the 16
/// arcs of nine points of the arc's least brightness above the centre, or of the centre above its
/// greatest. Runs of 2, 4, 8 points are shared between arcs.
template <class Lanes>
typename Lanes::Pixels arc_score_plus_one(const std::uint8_t* p, const Circle& circle,
                                          typename Lanes::Pixels centre) {
  using Pixels = typename Lanes::Pixels;
  Pixels point[16];
  Pixels low2[16];
  Pixels high2[16];
  for (int k = 0; k < 16; ++k) point[k] = Lanes::load(p + circle.offset[k]);
  for (int k = 0; k < 16; ++k) {
    low2[k] = Lanes::min(point[k], point[(k + 1) & 15]);
    high2[k] = Lanes::max(point[k], point[(k + 1) & 15]);
  }
  Pixels low4[16];
  Pixels high4[16];
  for (int k = 0; k < 16; ++k) {
    low4[k] = Lanes::min(low2[k], low2[(k + 2) & 15]);
    high4[k] = Lanes::max(high2[k], high2[(k + 2) & 15]);
  }
  Pixels brightest = Lanes::splat(0);
  Pixels darkest = Lanes::splat(255);
  for (int k = 0; k < 16; ++k) {
    const Pixels& last = point[(k + 8) & 15];
    brightest = Lanes::max(brightest, Lanes::min(Lanes::min(low4[k], low4[(k + 4) & 15]), last));
    darkest = Lanes::min(darkest, Lanes::max(Lanes::max(high4[k], high4[(k + 4) & 15]), last));
  }
  return Lanes::max(Lanes::subtract_saturated(brightest, centre),
                    Lanes::subtract_saturated(centre, darkest));
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
};

/// Scores of every corner among the kCount pixels at `p`, which are columns x.. of `row`.
template <class Lanes>
struct BlockScorer {
  using Pixels = typename Lanes::Pixels;

  static void score(const std::uint8_t* p, const Circle& circle, Pixels centre, Pixels threshold,
                    const AntipodalFilter<Lanes>& /*filter*/, int x, ScoreRow row) {
    const Pixels plus_one = arc_score_plus_one<Lanes>(p, circle, centre);
    std::uint32_t corners = Lanes::nonzero_mask(Lanes::subtract_saturated(plus_one, threshold));
    if (corners == 0) return;
    std::uint8_t scores[Lanes::kCount];
    Lanes::store(scores, plus_one);
    for (; corners != 0; corners &= corners - 1) {
      const int lane = __builtin_ctz(corners);
      row.set(x + lane, scores[lane] - 1);
    }
  }
};

/// Four lanes are too few to carry 16 arcs each: few of them survive the filter. The circle of one
/// surviving pixel at a time is spread over four words instead, and its 16 arcs run in the lanes.
template <>
struct BlockScorer<WordLanes> {
  static std::uint32_t gather(const std::uint8_t* p, const std::ptrdiff_t* offset) {
    return static_cast<std::uint32_t>(p[offset[0]]) |
           static_cast<std::uint32_t>(p[offset[1]]) << 8U |
           static_cast<std::uint32_t>(p[offset[2]]) << 16U |
           static_cast<std::uint32_t>(p[offset[3]]) << 24U;
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

  static void score(const std::uint8_t* p, const Circle& circle, std::uint32_t /*centre*/,
                    std::uint32_t threshold, const AntipodalFilter<WordLanes>& filter, int x,
                    ScoreRow row) {
    const int limit = static_cast<int>(threshold & 0xFFU);
    std::uint32_t bright = filter.bright();
    std::uint32_t dark = filter.dark();
    for (int lane = 0; lane < 4; ++lane, bright >>= 8U, dark >>= 8U) {
      if (((bright | dark) & 0xFFU) == 0) continue;
      const std::uint8_t* q = p + lane;
      const int centre = *q;
      const std::uint32_t w0 = gather(q, circle.offset);
      const std::uint32_t w1 = gather(q, circle.offset + 4);
      const std::uint32_t w2 = gather(q, circle.offset + 8);
      const std::uint32_t w3 = gather(q, circle.offset + 12);
      int best = 0;
      if ((bright & 0xFFU) != 0) best = largest_arc_minimum(w0, w1, w2, w3) - centre;
      if (best <= limit && (dark & 0xFFU) != 0) {
        best = centre - (255 - largest_arc_minimum(~w0, ~w1, ~w2, ~w3));
      }
      if (best > limit) row.set(x + lane, best - 1);
    }
  }
};

/// Corners and scores of the `Lanes::kCount` pixels at `p`.
template <class Lanes>
inline void scan_block(const std::uint8_t* p, const Circle& circle,
                       typename Lanes::Pixels threshold, int x, ScoreRow row) {
  const auto pair = [&](int k, typename Lanes::Pixels& a, typename Lanes::Pixels& b) {
    a = Lanes::load(p + circle.offset[k]);
    b = Lanes::load(p + circle.offset[k + 8]);
  };
  typename Lanes::Pixels a;
  typename Lanes::Pixels b;
  const typename Lanes::Pixels centre = Lanes::load(p);
  pair(0, a, b);
  AntipodalFilter<Lanes> filter(centre, threshold, a, b);
  if (filter.rejects()) return;
  // Pairs far apart on the circle first: they reject most.
  constexpr int kStages[4][2] = {{4, 4}, {2, 6}, {1, 3}, {5, 7}};
  for (const auto& stage : kStages) {
    pair(stage[0], a, b);
    filter.add_pair(a, b);
    if (stage[1] != stage[0]) {
      pair(stage[1], a, b);
      filter.add_pair(a, b);
    }
    if (filter.rejects()) return;
  }
  BlockScorer<Lanes>::score(p, circle, centre, threshold, filter, x, row);
}

/// Corners and scores of `count` >= kCount pixels from `first` on. The last block is moved back to
/// end at the last pixel; what it sees twice it scores twice the same.
template <class Lanes>
void scan_row(const std::uint8_t* first, const Circle& circle, int count, int threshold,
              ScoreRow row) {
  const auto limit = Lanes::splat(threshold);
  int x = 0;
  for (; x + Lanes::kCount <= count; x += Lanes::kCount) {
    scan_block<Lanes>(first + x, circle, limit, x, row);
  }
  if (x < count) {
    x = count - Lanes::kCount;
    scan_block<Lanes>(first + x, circle, limit, x, row);
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
                static_cast<std::size_t>(count + 2 * kCircleRadius));
  }
  std::uint8_t scores[Lanes::kCount] = {};
  std::uint32_t bits = 0;
  scan_row<Lanes>(window + kCircleRadius * kPitch + kCircleRadius, Circle(kPitch), Lanes::kCount,
                  threshold, {scores, &bits});
  std::memcpy(row.scores, scores, static_cast<std::size_t>(count));
  row.corner_bits[0] = bits & ((1U << static_cast<unsigned>(count)) - 1U);
}

}  // namespace cairn::vision
