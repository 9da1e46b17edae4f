#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "cairn/vision/detail/word_dsp.hpp"

#if defined(__SSE2__)
#include <emmintrin.h>
#define CAIRN_VISION_HAS_VECTOR 1
#elif defined(__ARM_NEON)
#include <arm_neon.h>
#define CAIRN_VISION_HAS_VECTOR 1
#elif defined(__ARM_FEATURE_MVE)
#include <arm_mve.h>
#define CAIRN_VISION_HAS_VECTOR 1
#else
#define CAIRN_VISION_HAS_VECTOR 0
#endif

namespace cairn::vision {

/// A lane type packs kCount neighbouring pixels into one `Pixels` value. The kernels are written
/// once over these operations, so back ends can differ in speed only:
///   load, splat, min, max, sort (both of them), add/subtract with saturation, none (all zero),
///   nonzero_mask (bit k set where lane k is not zero), store, and box_sum.
/// box_sum may read, but never uses, up to 15 bytes beyond the right edge of each row of the box.

/// One pixel at a time in plain C++: the reference that the others are tested against.
struct PortableLanes {
  static constexpr int kCount = 1;
  using Pixels = std::uint32_t;

  static Pixels load(const std::uint8_t* p) { return *p; }
  static void store(std::uint8_t* p, Pixels v) { *p = static_cast<std::uint8_t>(v); }
  static Pixels splat(int value) { return static_cast<Pixels>(value); }
  static Pixels min(Pixels a, Pixels b) { return a < b ? a : b; }
  static Pixels max(Pixels a, Pixels b) { return a > b ? a : b; }
  static void sort(Pixels a, Pixels b, Pixels& high, Pixels& low) {
    high = max(a, b);
    low = min(a, b);
  }
  static Pixels add_saturated(Pixels a, Pixels b) { return min(a + b, 255U); }
  static Pixels subtract_saturated(Pixels a, Pixels b) { return a > b ? a - b : 0U; }
  static Pixels either(Pixels a, Pixels b) { return a | b; }
  static Pixels where_nonzero(Pixels condition, Pixels v) { return condition != 0 ? v : 0U; }
  static bool none(Pixels v) { return v == 0; }
  static std::uint32_t nonzero_mask(Pixels v) { return v != 0 ? 1U : 0U; }

  static std::uint32_t box_sum(const std::uint8_t* p, std::ptrdiff_t stride, int width,
                               int height) {
    std::uint32_t sum = 0;
    for (int y = 0; y < height; ++y, p += stride) {
      for (int x = 0; x < width; ++x) sum += p[x];
    }
    return sum;
  }
};

/// Four pixels in a 32-bit word.
struct WordLanes {
  static constexpr int kCount = 4;
  using Pixels = std::uint32_t;

  static Pixels load(const std::uint8_t* p) {
    Pixels v = 0;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  static Pixels load_pair(const std::uint8_t* p) {
    std::uint16_t v = 0;
    std::memcpy(&v, p, sizeof v);
    return v;
  }
  static void store(std::uint8_t* p, Pixels v) { std::memcpy(p, &v, sizeof v); }
  static Pixels splat(int value) { return static_cast<Pixels>(value) * 0x01010101U; }
  static Pixels min(Pixels a, Pixels b) { return min_u8x4(a, b); }
  static Pixels max(Pixels a, Pixels b) { return max_u8x4(a, b); }
  static void sort(Pixels a, Pixels b, Pixels& high, Pixels& low) { sort_u8x4(a, b, high, low); }
  static Pixels add_saturated(Pixels a, Pixels b) { return add_saturated_u8x4(a, b); }
  static Pixels subtract_saturated(Pixels a, Pixels b) { return subtract_saturated_u8x4(a, b); }
  static Pixels either(Pixels a, Pixels b) { return a | b; }
  static bool none(Pixels v) { return v == 0; }
  static std::uint32_t nonzero_mask(Pixels v) {
    return ((v & 0xFFU) != 0 ? 1U : 0U) | ((v & 0xFF00U) != 0 ? 2U : 0U) |
           ((v & 0xFF0000U) != 0 ? 4U : 0U) | ((v & 0xFF000000U) != 0 ? 8U : 0U);
  }

  __attribute__((always_inline)) static std::uint32_t box_sum(const std::uint8_t* p,
                                                              std::ptrdiff_t stride, int width,
                                                              int height) {
    return width <= 16 ? narrow_box_sum(p, stride, width, height)
                       : wide_box_sum(p, stride, width, height);
  }

 private:
  // One call each: in the pattern's inner loop, and away from it.
  __attribute__((always_inline)) static std::uint32_t narrow_box_sum(const std::uint8_t* p,
                                                                     std::ptrdiff_t stride,
                                                                     int width, int height);
  static std::uint32_t wide_box_sum(const std::uint8_t* p, std::ptrdiff_t stride, int width,
                                    int height);
};

namespace detail {

/// Sum of a row of 4 * Words + Tail pixels. Written out, because -O2 does not unroll.
template <int Words, int Tail>
inline std::uint32_t sum_row(const std::uint8_t* p, ByteAdder add, std::uint32_t sum) {
  if constexpr (Words > 0) sum = add(WordLanes::load(p), sum);
  if constexpr (Words > 1) sum = add(WordLanes::load(p + 4), sum);
  if constexpr (Words > 2) sum = add(WordLanes::load(p + 8), sum);
  if constexpr (Words > 3) sum = add(WordLanes::load(p + 12), sum);
  if constexpr (Tail == 1) sum += p[4 * Words];
  if constexpr (Tail == 2) sum = add(WordLanes::load_pair(p + 4 * Words), sum);
  if constexpr (Tail == 3) sum = add(WordLanes::load(p + 4 * Words) & 0xFFFFFFU, sum);
  return sum;
}

template <int Words, int Tail>
inline std::uint32_t sum_rows(const std::uint8_t* p, std::ptrdiff_t stride, int height) {
  const ByteAdder add;
  std::uint32_t sum = 0;
  do {
    sum = sum_row<Words, Tail>(p, add, sum);
    p += stride;
  } while (--height != 0);
  return sum;
}

}  // namespace detail

inline std::uint32_t WordLanes::narrow_box_sum(const std::uint8_t* p, std::ptrdiff_t stride,
                                               int width, int height) {
  switch (width) {
    case 1:
      return detail::sum_rows<0, 1>(p, stride, height);
    case 2:
      return detail::sum_rows<0, 2>(p, stride, height);
    case 3:
      return detail::sum_rows<0, 3>(p, stride, height);
    case 4:
      return detail::sum_rows<1, 0>(p, stride, height);
    case 5:
      return detail::sum_rows<1, 1>(p, stride, height);
    case 6:
      return detail::sum_rows<1, 2>(p, stride, height);
    case 7:
      return detail::sum_rows<1, 3>(p, stride, height);
    case 8:
      return detail::sum_rows<2, 0>(p, stride, height);
    case 9:
      return detail::sum_rows<2, 1>(p, stride, height);
    case 10:
      return detail::sum_rows<2, 2>(p, stride, height);
    case 11:
      return detail::sum_rows<2, 3>(p, stride, height);
    case 12:
      return detail::sum_rows<3, 0>(p, stride, height);
    case 13:
      return detail::sum_rows<3, 1>(p, stride, height);
    case 14:
      return detail::sum_rows<3, 2>(p, stride, height);
    case 15:
      return detail::sum_rows<3, 3>(p, stride, height);
    case 16:
      return detail::sum_rows<4, 0>(p, stride, height);
    default:
      __builtin_unreachable();
  }
}

#if CAIRN_VISION_HAS_VECTOR

namespace detail {

/// Bytes 16 - n onwards: n of 0xFF, then zeros.
alignas(16) inline constexpr std::uint8_t kTailMask[32] = {
    255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255, 255,
    0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0,   0};

}  // namespace detail

#if defined(__SSE2__)

/// Sixteen pixels in an SSE2 register.
struct VectorLanes {
  static constexpr int kCount = 16;
  using Pixels = __m128i;

  static Pixels load(const std::uint8_t* p) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
  }
  static Pixels load_half(const std::uint8_t* p) {
    return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(p));
  }
  static void store(std::uint8_t* p, Pixels v) {
    _mm_storeu_si128(reinterpret_cast<__m128i*>(p), v);
  }
  static Pixels splat(int value) { return _mm_set1_epi8(static_cast<char>(value)); }
  static Pixels min(Pixels a, Pixels b) { return _mm_min_epu8(a, b); }
  static Pixels max(Pixels a, Pixels b) { return _mm_max_epu8(a, b); }
  static void sort(Pixels a, Pixels b, Pixels& high, Pixels& low) {
    high = max(a, b);
    low = min(a, b);
  }
  static Pixels add_saturated(Pixels a, Pixels b) { return _mm_adds_epu8(a, b); }
  static Pixels subtract_saturated(Pixels a, Pixels b) { return _mm_subs_epu8(a, b); }
  static Pixels either(Pixels a, Pixels b) { return _mm_or_si128(a, b); }
  static Pixels where_nonzero(Pixels condition, Pixels v) {
    return _mm_andnot_si128(_mm_cmpeq_epi8(condition, _mm_setzero_si128()), v);
  }
  static bool none(Pixels v) { return nonzero_mask(v) == 0; }
  static std::uint32_t nonzero_mask(Pixels v) {
    const int zero = _mm_movemask_epi8(_mm_cmpeq_epi8(v, _mm_setzero_si128()));
    return static_cast<std::uint32_t>(zero) ^ 0xFFFFU;
  }

  static std::uint32_t box_sum(const std::uint8_t* p, std::ptrdiff_t stride, int width,
                               int height) {
    const Pixels zero = _mm_setzero_si128();
    Pixels sum = zero;
    for (; width > 16; width -= 16, p += 16) {
      const std::uint8_t* row = p;
      for (int y = 0; y < height; ++y, row += stride) {
        sum = _mm_add_epi32(sum, _mm_sad_epu8(load(row), zero));
      }
    }
    const Pixels mask = load(detail::kTailMask + 16 - width);
    if (width <= 8) {
      // Two rows to a register.
      const Pixels both = _mm_unpacklo_epi64(mask, mask);
      for (; height >= 2; height -= 2, p += 2 * stride) {
        const Pixels rows = _mm_unpacklo_epi64(load_half(p), load_half(p + stride));
        sum = _mm_add_epi32(sum, _mm_sad_epu8(_mm_and_si128(rows, both), zero));
      }
    }
    for (int y = 0; y < height; ++y, p += stride) {
      sum = _mm_add_epi32(sum, _mm_sad_epu8(_mm_and_si128(load(p), mask), zero));
    }
    return static_cast<std::uint32_t>(_mm_cvtsi128_si32(sum)) +
           static_cast<std::uint32_t>(_mm_cvtsi128_si32(_mm_srli_si128(sum, 8)));
  }
};

#elif defined(__ARM_NEON)

/// Sixteen pixels in a NEON register.
struct VectorLanes {
  static constexpr int kCount = 16;
  using Pixels = uint8x16_t;

  static Pixels load(const std::uint8_t* p) { return vld1q_u8(p); }
  static void store(std::uint8_t* p, Pixels v) { vst1q_u8(p, v); }
  static Pixels splat(int value) { return vdupq_n_u8(static_cast<std::uint8_t>(value)); }
  static Pixels min(Pixels a, Pixels b) { return vminq_u8(a, b); }
  static Pixels max(Pixels a, Pixels b) { return vmaxq_u8(a, b); }
  static void sort(Pixels a, Pixels b, Pixels& high, Pixels& low) {
    high = max(a, b);
    low = min(a, b);
  }
  static Pixels add_saturated(Pixels a, Pixels b) { return vqaddq_u8(a, b); }
  static Pixels subtract_saturated(Pixels a, Pixels b) { return vqsubq_u8(a, b); }
  static Pixels either(Pixels a, Pixels b) { return vorrq_u8(a, b); }
  static Pixels where_nonzero(Pixels condition, Pixels v) {
    return vandq_u8(vtstq_u8(condition, condition), v);
  }
  static bool none(Pixels v) {
    const uint64x2_t halves = vreinterpretq_u64_u8(v);
    return (vgetq_lane_u64(halves, 0) | vgetq_lane_u64(halves, 1)) == 0;
  }
  static std::uint32_t nonzero_mask(Pixels v) {
    constexpr std::uint64_t kBits = 0x8040201008040201U;
    const uint8x16_t weights = vreinterpretq_u8_u64(vdupq_n_u64(kBits));
    const uint8x16_t bits = vandq_u8(vtstq_u8(v, v), weights);
    uint8x8_t sums = vpadd_u8(vget_low_u8(bits), vget_high_u8(bits));
    sums = vpadd_u8(sums, sums);
    sums = vpadd_u8(sums, sums);
    return vget_lane_u16(vreinterpret_u16_u8(sums), 0);
  }

  static std::uint32_t box_sum(const std::uint8_t* p, std::ptrdiff_t stride, int width,
                               int height) {
    uint32x4_t sum = vdupq_n_u32(0);
    for (; width > 16; width -= 16, p += 16) {
      const std::uint8_t* row = p;
      for (int y = 0; y < height; ++y, row += stride) {
        sum = vpadalq_u16(sum, vpaddlq_u8(load(row)));
      }
    }
    const Pixels mask = load(detail::kTailMask + 16 - width);
    for (int y = 0; y < height; ++y, p += stride) {
      sum = vpadalq_u16(sum, vpaddlq_u8(vandq_u8(load(p), mask)));
    }
    return vgetq_lane_u32(sum, 0) + vgetq_lane_u32(sum, 1) + vgetq_lane_u32(sum, 2) +
           vgetq_lane_u32(sum, 3);
  }
};

#else

/// Sixteen pixels in a Helium register. Comparisons give a predicate with a bit for each byte.
struct VectorLanes {
  static constexpr int kCount = 16;
  using Pixels = uint8x16_t;

  static Pixels load(const std::uint8_t* p) { return vld1q_u8(p); }
  static void store(std::uint8_t* p, Pixels v) { vst1q_u8(p, v); }
  static Pixels splat(int value) { return vdupq_n_u8(static_cast<std::uint8_t>(value)); }
  static Pixels min(Pixels a, Pixels b) { return vminq_u8(a, b); }
  static Pixels max(Pixels a, Pixels b) { return vmaxq_u8(a, b); }
  static void sort(Pixels a, Pixels b, Pixels& high, Pixels& low) {
    high = max(a, b);
    low = min(a, b);
  }
  static Pixels add_saturated(Pixels a, Pixels b) { return vqaddq_u8(a, b); }
  static Pixels subtract_saturated(Pixels a, Pixels b) { return vqsubq_u8(a, b); }
  static Pixels either(Pixels a, Pixels b) { return vorrq_u8(a, b); }
  static Pixels where_nonzero(Pixels condition, Pixels v) {
    return vpselq_u8(v, vdupq_n_u8(0), vcmpneq_n_u8(condition, 0));
  }
  static bool none(Pixels v) { return nonzero_mask(v) == 0; }
  static std::uint32_t nonzero_mask(Pixels v) { return vcmpneq_n_u8(v, 0); }

  static std::uint32_t box_sum(const std::uint8_t* p, std::ptrdiff_t stride, int width,
                               int height) {
    std::uint32_t sum = 0;
    for (; width > 16; width -= 16, p += 16) {
      const std::uint8_t* row = p;
      for (int y = 0; y < height; ++y, row += stride) sum = vaddvaq_u8(sum, load(row));
    }
    const mve_pred16_t inside = vctp8q(static_cast<std::uint32_t>(width));
    for (int y = 0; y < height; ++y, p += stride) {
      sum = vaddvaq_u8(sum, vld1q_z_u8(p, inside));
    }
    return sum;
  }
};

#endif
#endif

/// The back end of this build.
#if CAIRN_VISION_HAS_VECTOR
using NativeLanes = VectorLanes;
#elif defined(__ARM_FEATURE_SIMD32)
using NativeLanes = WordLanes;
#else
using NativeLanes = PortableLanes;
#endif

}  // namespace cairn::vision
