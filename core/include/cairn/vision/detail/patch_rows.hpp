#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <utility>

#include "cairn/vision/detail/word_dsp.hpp"
#include "cairn/vision/image.hpp"

#if defined(__ARM_FEATURE_SIMD32)
#include <arm_acle.h>
#endif

namespace cairn::vision {

/// Rows of signed 16-bit values that patch alignment works on: 11 values and a zero, two to a word
/// for the dual multiplications of Armv7E-M and Armv8-M. All functions give the same integers with
/// and without them.
inline constexpr int kPatchSide = 11;
inline constexpr int kRowPitch = 12;

/// Two signed 16-bit values, the first one below.
using Pair = std::uint32_t;

inline Pair load_pair(const std::int16_t* p) {
  Pair v = 0;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline void store_pair(std::int16_t* p, Pair v) {
  std::memcpy(p, &v, sizeof v);
}
inline std::int32_t low_half(Pair v) {
  return static_cast<std::int16_t>(v & 0xFFFFU);
}
inline std::int32_t high_half(Pair v) {
  return static_cast<std::int16_t>(v >> 16U);
}
inline Pair make_pair(std::int32_t low, std::int32_t high) {
  return (static_cast<std::uint32_t>(low) & 0xFFFFU) | static_cast<std::uint32_t>(high) << 16U;
}

#if defined(__ARM_FEATURE_SIMD32)
inline std::int32_t add_products(Pair a, Pair b, std::int32_t sum) {
  return __smlad(static_cast<int16x2_t>(a), static_cast<int16x2_t>(b), sum);
}
inline std::int64_t add_products(Pair a, Pair b, std::int64_t sum) {
  return __smlald(static_cast<int16x2_t>(a), static_cast<int16x2_t>(b), sum);
}
inline Pair add_pairs(Pair a, Pair b) {
  return static_cast<Pair>(__sadd16(static_cast<int16x2_t>(a), static_cast<int16x2_t>(b)));
}
inline Pair subtract_pairs(Pair a, Pair b) {
  return static_cast<Pair>(__ssub16(static_cast<int16x2_t>(a), static_cast<int16x2_t>(b)));
}
/// Each value divided by two, downwards.
inline Pair halve_pairs(Pair a) {
  return static_cast<Pair>(__shadd16(static_cast<int16x2_t>(a), 0));
}
#else
inline std::int32_t add_products(Pair a, Pair b, std::int32_t sum) {
  return sum + low_half(a) * low_half(b) + high_half(a) * high_half(b);
}
inline std::int64_t add_products(Pair a, Pair b, std::int64_t sum) {
  return sum + static_cast<std::int64_t>(low_half(a)) * low_half(b) +
         static_cast<std::int64_t>(high_half(a)) * high_half(b);
}
inline Pair add_pairs(Pair a, Pair b) {
  return make_pair(low_half(a) + low_half(b), high_half(a) + high_half(b));
}
inline Pair subtract_pairs(Pair a, Pair b) {
  return make_pair(low_half(a) - low_half(b), high_half(a) - high_half(b));
}
inline Pair halve_pairs(Pair a) {
  return make_pair(low_half(a) >> 1, high_half(a) >> 1);
}
#endif

/// Half the difference, towards zero.
inline Pair half_difference(Pair a, Pair b) {
  const Pair difference = subtract_pairs(a, b);
  return halve_pairs(add_pairs(difference, (difference >> 15U) & 0x00010001U));
}

/// A pair of one value's half of `a` and one of `b`. Written out, because compilers take two steps.
inline Pair lows(Pair a, Pair b) {
#if defined(__ARM_FEATURE_SIMD32)
  Pair result = 0;
  __asm__("pkhbt %0, %1, %2, lsl #16" : "=r"(result) : "r"(a), "r"(b));
  return result;
#else
  return (a & 0xFFFFU) | b << 16U;
#endif
}
inline Pair highs(Pair a, Pair b) {
#if defined(__ARM_FEATURE_SIMD32)
  Pair result = 0;
  __asm__("pkhtb %0, %1, %2, asr #16" : "=r"(result) : "r"(b), "r"(a));
  return result;
#else
  return a >> 16U | (b & 0xFFFF0000U);
#endif
}
inline Pair low_and_high(Pair a, Pair b) {
#if defined(__ARM_FEATURE_SIMD32)
  Pair result = 0;
  __asm__("pkhbt %0, %1, %2" : "=r"(result) : "r"(a), "r"(b));
  return result;
#else
  return (a & 0xFFFFU) | (b & 0xFFFF0000U);
#endif
}
/// Both values divided by 2^Shift, downwards; the quotients fit.
template <int Shift>
inline Pair shifted_pair(std::int32_t low, std::int32_t high) {
#if defined(__ARM_FEATURE_SIMD32)
  Pair result = 0;
  __asm__("pkhtb %0, %1, %2, asr %3"
          : "=r"(result)
          : "r"(static_cast<std::uint32_t>(high) << (16 - Shift)), "r"(low), "i"(Shift));
  return result;
#else
  return make_pair(low >> Shift, high >> Shift);
#endif
}

/// Calls f(0), f(2), ... for the pairs of a row. Written out, because -O2 does not unroll.
template <class F>
__attribute__((always_inline)) inline void for_each_pair(F f) {
  static_assert(kRowPitch == 12, "six pairs");
  f(0);
  f(2);
  f(4);
  f(6);
  f(8);
  f(10);
}

inline constexpr Pair kPairMasks[4] = {0, 0x0000FFFFU, 0xFFFF0000U, 0xFFFFFFFFU};

/// All bits of each of the two values whose bit is set: columns x and x + 1 of a row's flags.
inline Pair pair_mask(std::uint32_t flags, int x) {
  return kPairMasks[(flags >> static_cast<unsigned>(x)) & 3U];
}

/// Bilinear interpolation of a row of an image at one fraction (fx, fy) in 1/256 pixel: Q4, zero at
/// mid-grey. A row or column whose weight is zero is not read.
class RowSampler {
 public:
  static constexpr int kValueBits = 4;

  RowSampler(int fx, int fy, std::ptrdiff_t stride)
      : fx_(fx), fy_(fy), down_(fy != 0 ? stride : 0) {}

  /// From `p`, the row's first pixel, to out[0..kPatchSide); what is behind it may change.
  __attribute__((always_inline)) void sample(const std::uint8_t* p, std::int16_t* out) const {
#if defined(__ARM_FEATURE_SIMD32)
    const Columns first = columns(p, p + down_);
    const Columns second = columns(p + 4, p + 4 + down_);
    four_values(first, second, out);
    const Columns third = last_columns(p);
    four_values(second, third, out + 4);
    four_values(third, Columns{0, 0}, out + 8);
#else
    visit(p, [out](int x, std::int32_t value) { out[x] = static_cast<std::int16_t>(value); });
#endif
  }

  /// The same values one by one: f(column, value).
  template <class F>
  __attribute__((always_inline)) void visit(const std::uint8_t* p, F f) const {
    visit(p, f, std::make_integer_sequence<int, kPatchSide>());
  }

 private:
  static constexpr int kShift = 16 - kValueBits;
  static constexpr std::int32_t kHalf = 1 << (kShift - 1);

  // Written out, because -O2 does not unroll.
  template <class F, int... X>
  __attribute__((always_inline)) void visit(const std::uint8_t* p, F f,
                                            std::integer_sequence<int, X...>) const {
    const std::uint8_t* const below = keep_in_register(p + down_);
    const std::int32_t bias = keep_in_register(kHalf - (128 << 16));
    const std::int32_t from_left = keep_in_register(256 - fx_);
    const std::int32_t from_above = keep_in_register(256 - fy_);
    const auto column = [&](int x) __attribute__((always_inline)) {
      return p[x] * from_above + below[x] * fy_;
    };
    std::int32_t left = column(0);
    const auto step = [&](int x) __attribute__((always_inline)) {
      const bool ends = x == kPatchSide - 1 && fx_ == 0;
      const std::int32_t right = ends ? 0 : column(x + 1);
      f(x, (bias + left * from_left + right * fx_) >> kShift);
      left = right;
    };
    (step(X), ...);
  }

#if defined(__ARM_FEATURE_SIMD32)
  /// Columns 0 and 2, 1 and 3 of four, interpolated downwards: Q8, zero at mid-grey.
  struct Columns {
    Pair even;
    Pair odd;
  };
  static std::uint32_t load_word(const std::uint8_t* p) {
    std::uint32_t v = 0;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  __attribute__((always_inline)) Columns columns(const std::uint8_t* p,
                                                 const std::uint8_t* below) const {
    return columns(load_word(p), load_word(below));
  }
  __attribute__((always_inline)) Columns columns(std::uint32_t row, std::uint32_t below) const {
    // Bytes times weights that add up to 256 stay below 2^16: two at once in one multiplication.
    constexpr std::uint32_t kBytes = 0x00FF00FFU;
    constexpr std::uint32_t kMidGrey = 0x80008000U;
    const auto fy = static_cast<std::uint32_t>(fy_);
    const std::uint32_t even = (row & kBytes) * (256U - fy) + (below & kBytes) * fy;
    const std::uint32_t odd = (row >> 8U & kBytes) * (256U - fy) + (below >> 8U & kBytes) * fy;
    return {even ^ kMidGrey, odd ^ kMidGrey};
  }
  /// Columns 8 to 11, the last of them only where it has a weight.
  __attribute__((always_inline)) Columns last_columns(const std::uint8_t* p) const {
    // Without it the word is read one pixel earlier.
    const int early = fx_ != 0 ? 0 : 1;
    const auto shift = static_cast<unsigned>(8 * early);
    p += 8 - early;
    return columns(load_word(p) >> shift, load_word(p + down_) >> shift);
  }
  /// Between four columns and the first one of the next four.
  __attribute__((always_inline)) void four_values(const Columns& c, const Columns& next,
                                                  std::int16_t* out) const {
    store_pair(out, two_values(lows(c.even, c.odd), low_and_high(c.odd, c.even)));
    store_pair(out + 2, two_values(highs(c.even, c.odd), c.odd >> 16U | next.even << 16U));
  }
  __attribute__((always_inline)) Pair two_values(Pair first, Pair second) const {
    const Pair weights = make_pair(256 - fx_, fx_);
    return shifted_pair<kShift>(add_products(first, weights, kHalf),
                                add_products(second, weights, kHalf));
  }
#endif

  int fx_;
  int fy_;
  std::ptrdiff_t down_;
};

}  // namespace cairn::vision
