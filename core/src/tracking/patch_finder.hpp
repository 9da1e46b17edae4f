#pragma once

#include <cstring>
#include <utility>

#include "cairn/numeric/math.hpp"
#include "cairn/tracking/patch_search.hpp"
#include "cairn/tracking/work_budget.hpp"
#include "cairn/vision/detail/patch_rows.hpp"
#include "cairn/vision/detail/word_dsp.hpp"

// The search for a patch, over the windows in float and in fixed point.

namespace cairn::patch_finder {

inline constexpr int kHalf = 5;
inline constexpr int kSide = 2 * kHalf + 1;
inline constexpr int kPixels = kSide * kSide;
inline constexpr int kMargin = kHalf + 1;

/// The patch as the current view should show it: rows of 11 values and a zero.
struct Template {
  static constexpr int kPitch = kSide + 1;
  std::int16_t values[kSide * kPitch];
  std::int32_t sum = 0;
  std::int32_t coarse_sum = 0;  ///< of every second row
  std::int64_t spread = 0;      ///< kPixels^2 times the variance

  /// Where a row keeps the value of a column: as the board's instructions take bytes apart.
  static int place(int column) {
#if defined(__ARM_FEATURE_SIMD32)
    constexpr int kPlaces[4] = {0, 2, 1, 3};
    return (column & ~3) + kPlaces[column & 3];
#else
    return column;
#endif
  }
};

/// Sums over the pixels under a template.
struct Sums {
  std::int32_t sum = 0;
  std::int32_t squares = 0;
  std::int32_t product = 0;
};

/// Value of the patch at (u, v), Q16 from its first pixel.
inline std::int32_t patch_value(const Patch& patch, std::int32_t u, std::int32_t v) {
  const std::uint8_t* p = patch.pixels + (v >> 16) * Patch::kSize + (u >> 16);
  const std::int32_t fx = (u >> 8) & 255;
  const std::int32_t fy = (v >> 8) & 255;
  const std::int32_t top = (p[0] << 8) + (p[1] - p[0]) * fx;
  const std::int32_t bottom = (p[Patch::kSize] << 8) + (p[Patch::kSize + 1] - p[Patch::kSize]) * fx;
  return ((top << 8) + (bottom - top) * fy + 32768) >> 16;
}

/// Fills in a template's values with an inverse warp, Q16, held at the patch's border. `Position`:
/// an integer in which the positions of all pixels fit.
template <class Position>
void fill_template(const Patch& patch, Position xx, Position xy, Position yx, Position yy,
                   Template& out) {
  constexpr Position kCentre = (Patch::kSize / 2) << 16;
  constexpr Position kLast = ((Patch::kSize - 1) << 16) - 1;
  const auto inside = [](Position position) { return position >= 0 && position <= kLast; };
  out.sum = out.coarse_sum = 0;
  std::int64_t squares = 0;
  for (int row = 0; row < kSide; ++row) {
    const Position y = row - kHalf;
    Position u = kCentre + xy * y - xx * kHalf;
    Position v = kCentre + yy * y - yx * kHalf;
    std::int16_t* const values = out.values + row * Template::kPitch;
    std::int32_t row_sum = 0;
    std::int32_t row_squares = 0;
    const auto set = [&](int column, Position at_u, Position at_v) {
      const std::int32_t value =
          patch_value(patch, static_cast<std::int32_t>(at_u), static_cast<std::int32_t>(at_v));
      values[Template::place(column)] = static_cast<std::int16_t>(value);
      row_sum += value;
      row_squares += value * value;
    };
    constexpr int kSteps = kSide - 1;
    if (inside(u) && inside(v) && inside(u + kSteps * xx) && inside(v + kSteps * yx)) {
      for (int column = 0; column < kSide; ++column, u += xx, v += yx) set(column, u, v);
    } else {
      for (int column = 0; column < kSide; ++column, u += xx, v += yx) {
        set(column, clamp<Position>(u, 0, kLast), clamp<Position>(v, 0, kLast));
      }
    }
    values[kSide] = 0;
    out.sum += row_sum;
    if (row % 2 == 0) out.coarse_sum += row_sum;
    squares += row_squares;
  }
  out.spread = kPixels * squares - static_cast<std::int64_t>(out.sum) * out.sum;
}

inline bool make_template(const Patch& patch, const PatchWarp& warp, Template& out) {
  const std::int64_t determinant = static_cast<std::int64_t>(warp.xx) * warp.yy -
                                   static_cast<std::int64_t>(warp.xy) * warp.yx;  // Q32
  if (determinant < (std::int64_t{1} << 29)) return false;
  const std::int64_t scale = determinant >> 16;
  const auto inverse = [scale](std::int32_t entry) {
    return (static_cast<std::int64_t>(entry) * 65536) / scale;
  };
  const std::int64_t xx = inverse(warp.yy), xy = inverse(-warp.xy);
  const std::int64_t yx = inverse(-warp.yx), yy = inverse(warp.xx);
  constexpr std::int64_t kMost = 1 << 26;  // as every warp of a view: positions fit 32 bits
  const auto fits = [](std::int64_t entry) { return entry < kMost && entry > -kMost; };
  if (fits(xx) && fits(xy) && fits(yx) && fits(yy)) {
    fill_template(patch, static_cast<std::int32_t>(xx), static_cast<std::int32_t>(xy),
                  static_cast<std::int32_t>(yx), static_cast<std::int32_t>(yy), out);
  } else {
    fill_template(patch, xx, xy, yx, yy, out);
  }
  return out.spread >= 4 * kPixels * kPixels;
}

#if defined(__ARM_FEATURE_SIMD32)

/// Adds four pixels as two pairs of 16-bit values.
__attribute__((always_inline)) inline void add_word(std::uint32_t word, const std::int16_t* t,
                                                    const vision::ByteAdder& add_bytes,
                                                    Sums& sums) {
  sums.sum = static_cast<std::int32_t>(add_bytes(word, static_cast<std::uint32_t>(sums.sum)));
  const vision::Pair even = word & 0x00FF00FFU;
  const vision::Pair odd = (word >> 8U) & 0x00FF00FFU;
  sums.squares = vision::add_products(even, even, sums.squares);
  sums.squares = vision::add_products(odd, odd, sums.squares);
  sums.product = vision::add_products(even, vision::load_pair(t), sums.product);
  sums.product = vision::add_products(odd, vision::load_pair(t + 2), sums.product);
}

/// Adds a row of the image. Written out, because -O2 does not unroll.
__attribute__((always_inline)) inline void add_row(const std::uint8_t* p, const std::int16_t* t,
                                                   const vision::ByteAdder& add_bytes, Sums& sums) {
  static_assert(kSide == 11, "three words, of which the last pixel does not count");
  std::uint32_t words[3];
  std::memcpy(words, p, sizeof words);
  add_word(words[0], t, add_bytes, sums);
  add_word(words[1], t + 4, add_bytes, sums);
  add_word(words[2] & 0x00FFFFFFU, t + 8, add_bytes, sums);
}

#else

template <int... Column>
__attribute__((always_inline)) inline void add_row(const std::uint8_t* p, const std::int16_t* t,
                                                   Sums& sums,
                                                   std::integer_sequence<int, Column...>) {
  const auto add = [&](std::int32_t v, std::int32_t value) __attribute__((always_inline)) {
    sums.sum += v;
    sums.squares += v * v;
    sums.product += v * value;
  };
  (add(p[Column], t[Column]), ...);
}
__attribute__((always_inline)) inline void add_row(const std::uint8_t* p, const std::int16_t* t,
                                                   const vision::ByteAdder& /*add_bytes*/,
                                                   Sums& sums) {
  add_row(p, t, sums, std::make_integer_sequence<int, kSide>());
}

#endif

struct Best {
  int x = 0;
  int y = 0;
  std::int64_t score = 0;
};

/// Keeps (x, y) if it is better than `best`. Its score is the squared correlation times the
/// template's spread over every Step-th row, 0 where the correlation is not positive.
template <int Step>
void judge(const Sums& sums, int x, int y, const Template& t, Best& best) {
  constexpr std::int32_t kCount = (kSide + Step - 1) / Step * kSide;
  static_assert(kCount * kCount * 255LL * 255 < INT32_MAX, "spreads fit 32 bits");
  const std::int32_t template_sum = Step == 1 ? t.sum : t.coarse_sum;
  const std::int32_t spread = kCount * sums.squares - sums.sum * sums.sum;
  const std::int32_t covariance = kCount * sums.product - sums.sum * template_sum;
  if (spread <= 0 || covariance <= 0) return;
  // covariance^2 / spread > best.score without a division, which takes longer than all the rest.
  const std::int64_t squared = static_cast<std::int64_t>(covariance) * covariance;
  if (squared >= (best.score + 1) * spread) best = {x, y, squared / spread};
}

/// Domain: the pixel right of the window is inside the image.
template <int Step>
void try_at(const ImageView& image, int x, int y, const Template& t, Best& best) {
  const vision::ByteAdder add_bytes;
  Sums sums;
  const std::uint8_t* p = image.data + (y - kHalf) * image.stride + x - kHalf;
  for (int row = 0; row < kSide; row += Step, p += Step * image.stride) {
    add_row(p, t.values + row * Template::kPitch, add_bytes, sums);
  }
  judge<Step>(sums, x, y, t, best);
}

inline bool fits(const ImageView& image, int x, int y) {
  return x >= kMargin && y >= kMargin && x < image.width - kMargin && y < image.height - kMargin;
}

#if !defined(__ARM_FEATURE_SIMD32)

/// Adds a row of the image to the first, the last, and of three the middle one of three places
/// beside one another, which begin at `p`.
template <int Places, int... Column>
__attribute__((always_inline)) inline void add_row_to_all(const std::uint8_t* p,
                                                          const std::int16_t* t,
                                                          Sums (&places)[Places],
                                                          std::integer_sequence<int, Column...>) {
  constexpr int kLast = Places - 1;
  std::int32_t left = p[0];
  std::int32_t middle = p[1];
  Sums common;  // of the pixels that all have
  std::int32_t products[Places] = {};
  const auto add = [&](int column) __attribute__((always_inline)) {
    const std::int32_t right = p[column + 2];
    const std::int32_t value = t[column];
    products[0] += left * value;
    if constexpr (Places == 3) products[1] += middle * value;
    products[kLast] += right * value;
    left = middle;
    middle = right;
    if (column + 2 >= kSide) return;
    common.sum += right;
    common.squares += right * right;
  };
  (add(Column), ...);
  const auto finish = [&](int k, int other, int another) __attribute__((always_inline)) {
    const std::int32_t a = p[other];
    const std::int32_t b = p[another];
    places[k].sum += common.sum + a + b;
    places[k].squares += common.squares + a * a + b * b;
    places[k].product += products[k];
  };
  finish(0, 0, 1);
  if constexpr (Places == 3) finish(1, 1, kSide);
  finish(kLast, kSide, kSide + 1);
}

/// The places x and x + 2, or all three, as try_at(); all in the image.
template <int Step, int Places>
void try_beside(const ImageView& image, int x, int y, const Template& t, Best& best) {
  static_assert(Places == 2 || Places == 3, "of three");
  Sums places[Places];
  const std::uint8_t* p = image.data + (y - kHalf) * image.stride + x - kHalf;
  for (int row = 0; row < kSide; row += Step, p += Step * image.stride) {
    add_row_to_all<Places>(p, t.values + row * Template::kPitch, places,
                           std::make_integer_sequence<int, kSide>());
  }
  for (int k = 0; k < Places; ++k) judge<Step>(places[k], x + k * (2 / (Places - 1)), y, t, best);
}

#endif

/// The best of the pixels around a place.
inline Best search_around(const ImageView& image, const Best& place, const Template& t) {
  Best best;
  for (int y = place.y - 1; y <= place.y + 1; ++y) {
#if !defined(__ARM_FEATURE_SIMD32)
    if (fits(image, place.x - 1, y) && fits(image, place.x + 1, y)) {
      try_beside<1, 3>(image, place.x - 1, y, t, best);
      continue;
    }
#endif
    for (int x = place.x - 1; x <= place.x + 1; ++x) {
      if (fits(image, x, y)) try_at<1>(image, x, y, t, best);
    }
  }
  return best;
}

/// The best of every second pixel of every second row of the window.
template <class Window>
Best search_coarsely(const ImageView& image, const Window& window, const Template& t) {
  const int u = window.middle_x();
  const int v = window.middle_y();
  Best best;
  int tried = 0;
  for (int y = v - window.half_y(); y <= v + window.half_y(); y += 2) {
    int first = 0;
    int last = 0;
    if (!window.columns(y, first, last)) continue;
    int x = u - window.half_x();
    if (first > x) x += (first - x + 1) & ~1;
    if (last > u + window.half_x()) last = u + window.half_x();
    const auto counts = [&](int column) {
      return column <= last && tried < window.places() && window.contains(column, y) &&
             fits(image, column, y);
    };
    for (; x <= last && tried < window.places(); x += 2) {
      if (!counts(x)) continue;
      ++tried;
#if !defined(__ARM_FEATURE_SIMD32)
      if (counts(x + 2)) {
        ++tried;
        try_beside<2, 2>(image, x, y, t, best);
        x += 2;
        continue;
      }
#endif
      try_at<2>(image, x, y, t, best);
    }
  }
  return best;
}

struct PlaceQ8 {
  int x = 0;
  int y = 0;
};

template <class Window>
Status find_patch(const ImageView& image, const Window& window, const Patch& patch,
                  const PatchWarp& warp, const PatchSearchParameters& parameters, PlaceQ8& found) {
  Template t;
  if (!make_template(patch, warp, t)) return Status::kDegenerate;

  const Best coarse = search_coarsely(image, window, t);
  if (coarse.score == 0) return Status::kNotFound;
  const Best best = search_around(image, coarse, t);
  const std::int64_t wanted =
      static_cast<std::int64_t>(parameters.min_correlation_q10) * parameters.min_correlation_q10;
  if ((best.score << 20) < wanted * t.spread) return Status::kNotFound;

  found = {best.x * 256, best.y * 256};
  PatchAlignment alignment;
  if (!ok(align_patch(image, patch, warp, found.x, found.y, alignment))) return Status::kNotFound;
  if (!alignment.converged || alignment.correlation < parameters.min_aligned_q10 ||
      !window.contains_q8(found.x, found.y)) {
    return Status::kNotFound;
  }
  return Status::kOk;
}

inline int work_of(int places) {
  constexpr int kItself = 8 + work::kAlignment;
  constexpr int kPlacesPerUnit = 3;
  return kItself + places / kPlacesPerUnit;
}

}  // namespace cairn::patch_finder
