#include "cairn/numeric/float_bits.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

using Q20 = Fixed<std::int32_t, 20>;
using Q44 = Fixed<std::int64_t, 44>;

/// Of any exponent between 2^-40 and 2^20, any sign.
float any_float(Random& random) {
  const float fraction = 1.0F + static_cast<float>(random.below(1 << 23)) / 8388608.0F;
  const float magnitude = std::ldexp(fraction, random.below(60) - 40);
  return random.below(2) == 0 ? magnitude : -magnitude;
}

TEST(FloatBits, GiveTheNearestFixedNumber) {
  Random random(3);
  for (int k = 0; k < 20000; ++k) {
    const float value = any_float(random);
    std::uint32_t lost = 0;
    const Q20 fixed = fixed_of<Q20>(value, lost);
    if (std::fabs(value) >= 2048.0F) {
      EXPECT_EQ(lost, 1U) << value;
      EXPECT_EQ(std::abs(fixed.raw()), INT32_MAX) << value;
      EXPECT_EQ(fixed.raw() > 0, value > 0.0F) << value;
      continue;
    }
    EXPECT_EQ(lost, 0U) << value;
    EXPECT_LE(std::fabs(std::ldexp(static_cast<float>(fixed.raw()), -20) - value),
              std::ldexp(0.5F, -20) + std::fabs(value) * 6e-8F)
        << value;
  }
}

TEST(FloatBits, GiveTheNearestFloat) {
  Random random(4);
  for (int k = 0; k < 20000; ++k) {
    const auto high = static_cast<std::uint64_t>(random.below(INT32_MAX));
    const auto raw = static_cast<std::int64_t>(high << 32U |
                                               static_cast<std::uint64_t>(random.below(INT32_MAX)));
    const std::int64_t value = (k % 2 == 0 ? raw : -raw) >> random.below(63);
    EXPECT_EQ(float_of(Q44::from_raw(value)), std::ldexp(static_cast<float>(value), -44)) << value;
  }
  EXPECT_EQ(float_of(Q44()), 0.0F);
  // Halves go to the even neighbour, and a mantissa that overflows to the next power.
  EXPECT_EQ(float_of(Q20::from_raw((1 << 24) + 1)), 16.0F);
  EXPECT_EQ(float_of(Q20::from_raw((1 << 24) + 3)), 16.0F + 4.0F / 1048576.0F);
  EXPECT_EQ(float_of(Q20::from_raw((1 << 25) - 1)), 32.0F);
}

TEST(FloatBits, WhatIsNoNumberIsCounted) {
  std::uint32_t lost = 0;
  EXPECT_EQ(fixed_of<Q20>(std::numeric_limits<float>::quiet_NaN(), lost).raw(), 0);
  EXPECT_EQ(lost, 1U);
  lost = 0;
  EXPECT_EQ(fixed_of<Q20>(-std::numeric_limits<float>::infinity(), lost).raw(), -INT32_MAX);
  EXPECT_GE(lost, 1U);
  lost = 0;
  EXPECT_EQ(fixed_of<Q20>(std::numeric_limits<float>::denorm_min(), lost).raw(), 0);
  EXPECT_EQ(fixed_of<Q20>(-0.0F, lost).raw(), 0);
  EXPECT_EQ(lost, 0U);
}

}  // namespace
}  // namespace cairn
