#include "cairn/numeric/float_bits.hpp"

#include <cstring>

namespace cairn::detail {
namespace {

constexpr int kMantissaBits = 23;
constexpr int kBias = 127;
constexpr std::uint32_t kExponents = 255;
constexpr std::uint32_t kSign = std::uint32_t{1} << 31;
constexpr std::uint32_t kOne = std::uint32_t{1} << kMantissaBits;

}  // namespace

std::int64_t fixed_from_float(float value, int fraction_bits, std::uint32_t& saturations) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &value, sizeof bits);
  const std::uint32_t exponent = (bits >> kMantissaBits) & kExponents;
  const std::uint32_t fraction = bits & (kOne - 1U);
  if (exponent == kExponents) {
    ++saturations;
    if (fraction != 0U) return 0;
    return (bits & kSign) != 0U ? -wide::kMostInt64 : wide::kMostInt64;
  }
  // Numbers below the smallest normal one are below every format's unit.
  if (exponent == 0U) return 0;
  const std::uint32_t mantissa = kOne | fraction;
  const int shift = static_cast<int>(exponent) - kBias - kMantissaBits + fraction_bits;
  std::int64_t magnitude = 0;
  if (shift > 62 - kMantissaBits) {
    ++saturations;
    magnitude = wide::kMostInt64;
  } else if (shift >= 0) {
    magnitude = std::int64_t{mantissa} << shift;
  } else if (shift >= -kMantissaBits - 1) {
    magnitude = static_cast<std::int32_t>(((mantissa >> (-shift - 1)) + 1U) >> 1U);
  }
  return (bits & kSign) != 0U ? -magnitude : magnitude;
}

float float_from_fixed(std::int64_t raw, int fraction_bits) {
  std::uint32_t bits = 0;
  const std::uint64_t magnitude = wide::magnitude(raw);
  if (magnitude != 0U) {
    int exponent = wide::bit_length(magnitude) - 1;
    std::uint64_t mantissa = magnitude;
    if (exponent > kMantissaBits) {
      // To nearest, halves to even.
      const int down = exponent - kMantissaBits;
      const std::uint64_t half = std::uint64_t{1} << (down - 1);
      const std::uint64_t lost = magnitude & ((half << 1) - 1U);
      mantissa = magnitude >> down;
      if (lost > half || (lost == half && (mantissa & 1U) != 0U)) ++mantissa;
      if (mantissa == std::uint64_t{kOne} << 1) {
        mantissa >>= 1;
        ++exponent;
      }
    } else {
      mantissa = magnitude << (kMantissaBits - exponent);
    }
    bits = (static_cast<std::uint32_t>(exponent + kBias - fraction_bits) << kMantissaBits) |
           (static_cast<std::uint32_t>(mantissa) & (kOne - 1U));
    if (raw < 0) bits |= kSign;
  }
  float value = 0.0F;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

}  // namespace cairn::detail
