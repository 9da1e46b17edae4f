#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "cairn/vision/detail/word_dsp.hpp"

#include "vector_lanes.hpp"

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

/// The same for cores that take one pixel at a time: the kernels have ways of their own for it.
struct PixelLanes : PortableLanes {
  /// Four columns at once.
  static std::uint32_t box_sum(const std::uint8_t* p, std::ptrdiff_t stride, int width,
                               int height) {
    std::uint32_t sum = 0;
    for (int x = width & ~3; x > 0; x -= 4, p += 4) {
      const std::uint8_t* q = p;
      for (int y = height; y > 0; --y, q += stride) sum += q[0] + q[1] + q[2] + q[3];
    }
    for (int x = width & 3; x > 0; --x, ++p) {
      const std::uint8_t* q = p;
      for (int y = height; y > 0; --y, q += stride) sum += *q;
    }
    return sum;
  }
};

/// Shifts into `bits` from below whether a >= b.
inline void append_comparison(std::uint32_t& bits, std::uint32_t a, std::uint32_t b) {
#if defined(__ARM_ARCH_ISA_THUMB) && __ARM_ARCH_ISA_THUMB >= 2
  // The carry of the comparison goes straight into the sum; compilers take twice as many steps.
  __asm__("cmp %1, %2\n\tadc %0, %0, %0" : "+r"(bits) : "r"(a), "r"(b) : "cc");
#else
  bits = 2 * bits + (a >= b ? 1U : 0U);
#endif
}

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

/// The back end of this build.
#if CAIRN_VISION_HAS_VECTOR
using NativeLanes = VectorLanes;
#elif defined(__ARM_FEATURE_SIMD32)
using NativeLanes = WordLanes;
#else
using NativeLanes = PixelLanes;
#endif

}  // namespace cairn::vision
