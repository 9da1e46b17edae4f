#pragma once

#include <cstdint>

namespace cairn::wide {

/// Integer steps of fixed-point arithmetic: rounded to nearest (halves up where nothing else is
/// said), saturated to +-(2^63 - 1), the same on every target. `saturations` grows by one where a
/// result did not fit.

inline constexpr std::int64_t kMostInt64 = INT64_MAX;

/// Bits up to and with the highest one set; 0 for 0.
constexpr int bit_length(std::uint64_t value) {
  return value == 0 ? 0 : 64 - __builtin_clzll(value);
}

constexpr std::uint64_t magnitude(std::int64_t value) {
  return value < 0 ? ~static_cast<std::uint64_t>(value) + 1U : static_cast<std::uint64_t>(value);
}

/// value / 2^shift. Domain: 0 <= shift <= 63.
constexpr std::int64_t round_shift(std::int64_t value, int shift) {
  return shift == 0 ? value : (value >> shift) + ((value >> (shift - 1)) & 1);
}

/// The same with fewer instructions on 32-bit cores. Domain: 2 <= shift <= 63.
constexpr std::int64_t round_shift_far(std::int64_t value, int shift) {
  return ((value >> (shift - 1)) + 1) >> 1;
}

/// The upper half of a product, rounded down.
constexpr std::int32_t high_product(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>((std::int64_t{a} * b) >> 32);
}

/// Sets words to 0, without the C library: small ones do it byte by byte. Domain: any count.
inline void clear(std::int32_t* words, int count) {
  std::int32_t nothing = 0;
  __asm__("" : "+r"(nothing));
  for (int i = 0; i < count; ++i) words[i] = nothing;
}

/// value 2^shift, for shifts of either sign.
std::int64_t scale(std::int64_t value, int shift, std::uint32_t& saturations);

constexpr std::int64_t add(std::int64_t a, std::int64_t b, std::uint32_t& saturations) {
  if (b > 0 ? a > kMostInt64 - b : a < -kMostInt64 - b) {
    ++saturations;
    return b > 0 ? kMostInt64 : -kMostInt64;
  }
  return a + b;
}

/// value within +-(2^31 - 1).
constexpr std::int32_t narrow(std::int64_t value, std::uint32_t& saturations) {
  if (value > INT32_MAX || value < -INT32_MAX) {
    ++saturations;
    return value > 0 ? INT32_MAX : -INT32_MAX;
  }
  return static_cast<std::int32_t>(value);
}

/// a b / 2^shift, the product exact; halves go away from zero. Domain: 0 <= shift <= 126.
std::int64_t multiply(std::int64_t a, std::int64_t b, int shift, std::uint32_t& saturations);

/// a 2^shift / b. By zero: the largest number of a's sign, counted; 0 / 0 is 0. Halves go away from
/// zero. Domain: 0 <= shift <= 126. Cost: at most `shift` divisions, two or three where b is
/// below 2^32.
std::int64_t divide(std::int64_t a, std::int64_t b, int shift, std::uint32_t& saturations);

}  // namespace cairn::wide
