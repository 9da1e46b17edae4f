#pragma once

#include <cstddef>
#include <cstdint>

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

/// Lanes of the compiler's vector unit, 16 pixels wide: the operations of lanes.hpp.
namespace cairn::vision {

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

}  // namespace cairn::vision
