#include "cairn/numeric/wide_integer.hpp"

namespace cairn::wide {

std::int64_t scale(std::int64_t value, int shift, std::uint32_t& saturations) {
  if (shift < 0) return shift < -63 ? 0 : round_shift(value, -shift);
  if (value == 0) return 0;
  if (shift + bit_length(magnitude(value)) > 63) {
    ++saturations;
    return value < 0 ? -kMostInt64 : kMostInt64;
  }
  return value * (std::int64_t{1} << shift);
}

std::int64_t multiply(std::int64_t a, std::int64_t b, int shift, std::uint32_t& saturations) {
  const bool negative = (a < 0) != (b < 0);
  const std::uint64_t x = magnitude(a);
  const std::uint64_t y = magnitude(b);
  if ((x | y) >> 32U == 0) {  // as most are: one product
    const std::uint64_t product = x * y;
    if (shift == 0 ? product <= static_cast<std::uint64_t>(kMostInt64) : shift < 64) {
      const std::uint64_t rounded = shift == 0 ? product : ((product >> (shift - 1)) + 1U) >> 1U;
      const auto result = static_cast<std::int64_t>(rounded);
      return negative ? -result : result;
    }
  }
  const std::uint64_t x0 = static_cast<std::uint32_t>(x);
  const std::uint64_t x1 = x >> 32U;
  const std::uint64_t y0 = static_cast<std::uint32_t>(y);
  const std::uint64_t y1 = y >> 32U;
  const std::uint64_t bottom = x0 * y0;
  const std::uint64_t cross = x1 * y0 + (bottom >> 32U);
  const std::uint64_t middle = x0 * y1 + static_cast<std::uint32_t>(cross);
  std::uint64_t high = x1 * y1 + (cross >> 32U) + (middle >> 32U);
  std::uint64_t low = (middle << 32U) | static_cast<std::uint32_t>(bottom);
  if (shift > 0) {
    const std::uint64_t half = std::uint64_t{1} << static_cast<unsigned>((shift - 1) % 64);
    low += shift <= 64 ? half : 0;
    high += shift <= 64 ? (low < half ? 1U : 0U) : half;
    if (shift >= 64) {
      low = high >> static_cast<unsigned>(shift - 64);
      high = 0;
    } else {
      low = (low >> static_cast<unsigned>(shift)) | (high << static_cast<unsigned>(64 - shift));
      high >>= static_cast<unsigned>(shift);
    }
  }
  if (high != 0 || low > static_cast<std::uint64_t>(kMostInt64)) {
    ++saturations;
    return negative ? -kMostInt64 : kMostInt64;
  }
  const auto result = static_cast<std::int64_t>(low);
  return negative ? -result : result;
}

std::int64_t divide(std::int64_t a, std::int64_t b, int shift, std::uint32_t& saturations) {
  if (a == 0 && b != 0) return 0;
  const bool negative = (a < 0) != (b < 0);
  const std::uint64_t divisor = magnitude(b);
  bool fits = divisor != 0;
  std::uint64_t quotient = 0;
  if (fits && shift <= 64 - bit_length(magnitude(a))) {  // as most do: one division
    const std::uint64_t grown = magnitude(a) << shift;
    quotient = grown / divisor;
    const std::uint64_t rest = grown - quotient * divisor;
    if (rest >= divisor - rest) ++quotient;
    fits = quotient <= static_cast<std::uint64_t>(kMostInt64);
  } else if (fits) {
    quotient = magnitude(a) / divisor;
    std::uint64_t rest = magnitude(a) - quotient * divisor;
    // As many bits at once as the rest leaves room for: rest < divisor <= 2^63, so at least one.
    for (int left = shift; left > 0 && fits;) {
      const int free = rest == 0 ? left : __builtin_clzll(rest);
      const int bits = free < left ? free : left;
      fits = quotient == 0 || bits + bit_length(quotient) < 64;
      if (!fits || rest == 0) {
        quotient <<= fits ? bits : 0;
        break;
      }
      const std::uint64_t grown = rest << bits;
      const std::uint64_t digits = grown / divisor;
      quotient = (quotient << bits) + digits;
      rest = grown - digits * divisor;
      left -= bits;
    }
    if (rest >= divisor - rest) ++quotient;
    fits = fits && quotient <= static_cast<std::uint64_t>(kMostInt64);
  }
  if (!fits) {
    ++saturations;
    if (a == 0) return 0;
    return negative ? -kMostInt64 : kMostInt64;
  }
  const auto result = static_cast<std::int64_t>(quotient);
  return negative ? -result : result;
}

}  // namespace cairn::wide
