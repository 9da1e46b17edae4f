#pragma once

#include <cstdint>

#if defined(__ARM_FEATURE_SIMD32)
#include <arm_acle.h>
#endif

namespace cairn::vision {

/// Hides what `value` is from the optimiser, which on Thumb would rather compute it anew, or load
/// it from the stack, than keep it.
template <class T>
inline T keep_in_register(T value) {
#if defined(__thumb__)
  __asm__("" : "+r"(value));
#endif
  return value;
}

/// Four unsigned bytes in a 32-bit word, as the DSP extension of Armv7E-M and Armv8-M works on
/// them. Where it is missing the same functions are plain C++, so that code written for the board
/// is tested on the host.
#if defined(__ARM_FEATURE_SIMD32)

inline std::uint32_t max_u8x4(std::uint32_t a, std::uint32_t b) {
  __usub8(a, b);  // sets a GE flag for each byte with a >= b; SEL reads them
  return __sel(a, b);
}
inline std::uint32_t min_u8x4(std::uint32_t a, std::uint32_t b) {
  __usub8(a, b);
  return __sel(b, a);
}
/// Both at once: the comparison is shared.
inline void sort_u8x4(std::uint32_t a, std::uint32_t b, std::uint32_t& high, std::uint32_t& low) {
  __usub8(a, b);
  high = __sel(a, b);
  low = __sel(b, a);
}
inline std::uint32_t add_saturated_u8x4(std::uint32_t a, std::uint32_t b) {
  return __uqadd8(a, b);
}
inline std::uint32_t subtract_saturated_u8x4(std::uint32_t a, std::uint32_t b) {
  return __uqsub8(a, b);
}
/// Adds the bytes of a to sum.
class ByteAdder {
 public:
  // Hidden from the optimiser, which would load the constant anew before every use.
  ByteAdder() { __asm__("" : "+r"(zero_)); }
  std::uint32_t operator()(std::uint32_t a, std::uint32_t sum) const {
    return __usada8(a, zero_, sum);
  }

 private:
  std::uint32_t zero_ = 0;
};

#else

/// 0xFF in each byte with a >= b: USUB8's GE flags, spread out. A byte of `borrow` has its top bit
/// set where a < b: either the top bits decide, or the difference of the lower seven bits does.
inline std::uint32_t not_less_u8x4(std::uint32_t a, std::uint32_t b) {
  const std::uint32_t kTop = 0x80808080U;
  const std::uint32_t difference = (a | kTop) - (b & ~kTop);
  const std::uint32_t borrow = ((~a & b) | (~(a ^ b) & ~difference)) & kTop;
  const std::uint32_t not_less = borrow ^ kTop;
  return (not_less - (not_less >> 7U)) | not_less;
}
inline std::uint32_t select_u8x4(std::uint32_t mask, std::uint32_t a, std::uint32_t b) {
  return b ^ ((a ^ b) & mask);
}
inline std::uint32_t max_u8x4(std::uint32_t a, std::uint32_t b) {
  return select_u8x4(not_less_u8x4(a, b), a, b);
}
inline std::uint32_t min_u8x4(std::uint32_t a, std::uint32_t b) {
  return select_u8x4(not_less_u8x4(a, b), b, a);
}
inline void sort_u8x4(std::uint32_t a, std::uint32_t b, std::uint32_t& high, std::uint32_t& low) {
  const std::uint32_t mask = not_less_u8x4(a, b);
  high = select_u8x4(mask, a, b);
  low = select_u8x4(mask, b, a);
}
inline std::uint32_t subtract_saturated_u8x4(std::uint32_t a, std::uint32_t b) {
  // max(a, b) - b never borrows across bytes.
  return max_u8x4(a, b) - b;
}
inline std::uint32_t add_saturated_u8x4(std::uint32_t a, std::uint32_t b) {
  // a + min(b, 255 - a) never carries across bytes.
  return a + min_u8x4(b, ~a);
}
struct ByteAdder {
  std::uint32_t operator()(std::uint32_t a, std::uint32_t sum) const {
    const std::uint32_t pairs = (a & 0x00FF00FFU) + ((a >> 8U) & 0x00FF00FFU);
    return sum + (pairs & 0xFFFFU) + (pairs >> 16U);
  }
};

#endif

}  // namespace cairn::vision
