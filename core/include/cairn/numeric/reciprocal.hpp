#pragma once

#include "cairn/numeric/wide_integer.hpp"

namespace cairn {

/// 1 / value, of which dividing many by one number is made: no division of 64 bits.
class Reciprocal {
 public:
  /// Domain: 0 < value.
  explicit Reciprocal(std::int32_t value) {
    const int length = wide::bit_length(static_cast<std::uint64_t>(value));
    const auto z = static_cast<std::uint32_t>(value) << (32 - length);  // 2^31 to 2^32
    // Its inverse from 1 to 2, to 16 bits and by a step of Newton's method, y (2 - z y).
    const std::uint32_t first = (UINT32_MAX / (z >> 16U)) << 14U;
    const auto product = static_cast<std::uint32_t>((std::uint64_t{z} * first) >> 32U);
    const std::uint32_t factor = (1U << 31U) - product;
    inverse_ = static_cast<std::uint32_t>((std::uint64_t{first} * factor) >> 30U);
    bits_ = 30 + length;
  }
  /// x / value with `fraction` bits, an error of a few 2^-29 of it. Domain: where fraction is
  /// larger than 30 and the bits of the value, the quotient fits.
  std::int64_t times(std::int32_t x, int fraction) const {
    const std::int64_t product = std::int64_t{x} * inverse_;
    const int shift = bits_ - fraction;
    return shift >= 0 ? wide::round_shift(product, shift < 63 ? shift : 63)
                      : product * (std::int64_t{1} << -shift);
  }

 private:
  std::uint32_t inverse_ = 0;
  int bits_ = 0;
};

}  // namespace cairn
