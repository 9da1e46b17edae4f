// Fixed-point arithmetic for any operands, against integers of 128 bits and long double.
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "cairn/numeric/fixed_math.hpp"

#include "any_integer.hpp"

namespace cairn {
namespace {

/// What is expected of a result whose exact magnitude, rounded, is `rounded`.
void expect_saturated(std::int64_t result, bool negative, Int128 rounded, bool fits,
                      std::uint32_t count) {
  const std::int64_t size = fits ? static_cast<std::int64_t>(rounded) : INT64_MAX;
  RC_ASSERT(result == (negative ? -size : size));
  RC_ASSERT(count == (fits ? 0U : 1U));
}

TEST(FixedProperty, ProductsAreTheNearestOrSaturate) {
  EXPECT_TRUE(rc::check([] {
    const std::int64_t a = *operand();
    const std::int64_t b = *operand();
    const int shift = *rc::gen::inRange(0, 127);
    const Int128 product = magnitude128(Int128{a} * b);
    const Int128 rounded =
        shift == 0 ? product : (product >> shift) + ((product >> (shift - 1)) & 1);
    std::uint32_t count = 0;
    const std::int64_t result = wide::multiply(a, b, shift, count);
    expect_saturated(result, (a < 0) != (b < 0), rounded, rounded <= INT64_MAX, count);
  }));
}

TEST(FixedProperty, QuotientsAreTheNearestOrSaturate) {
  EXPECT_TRUE(rc::check([] {
    const std::int64_t a = *operand();
    const std::int64_t b = *operand();
    const int shift = *rc::gen::inRange(0, 127);
    std::uint32_t count = 0;
    const std::int64_t result = wide::divide(a, b, shift, count);
    if (b == 0) {
      RC_ASSERT(count == 1U);
      RC_ASSERT(result == (a == 0 ? 0 : (a < 0 ? -INT64_MAX : INT64_MAX)));
      return;
    }
    // Bit by bit, as on paper.
    Int128 quotient = magnitude128(a) / magnitude128(b);
    Int128 rest = magnitude128(a) % magnitude128(b);
    bool fits = true;
    for (int i = 0; i < shift && fits; ++i) {
      rest *= 2;
      quotient = quotient * 2 + (rest >= magnitude128(b) ? 1 : 0);
      rest %= magnitude128(b);
      fits = quotient <= INT64_MAX;
    }
    if (2 * rest >= magnitude128(b)) ++quotient;
    expect_saturated(result, (a < 0) != (b < 0), quotient, fits && quotient <= INT64_MAX, count);
  }));
}

TEST(FixedProperty, SumsAndScalesAreExactOrSaturate) {
  EXPECT_TRUE(rc::check([] {
    const std::int64_t a = *operand();
    const std::int64_t b = *operand();
    const int shift = *rc::gen::inRange(-80, 80);
    std::uint32_t count = 0;
    const Int128 sum = Int128{a} + b;
    const bool sum_fits = magnitude128(sum) <= INT64_MAX;
    const std::int64_t added = wide::add(a, b, count);
    expect_saturated(added, sum < 0, magnitude128(sum), sum_fits, count);

    count = 0;
    const std::int64_t scaled = wide::scale(a, shift, count);
    if (shift >= 0) {
      const bool fits = a == 0 || (shift < 64 && magnitude128(Int128{a}) <= (INT64_MAX >> shift));
      const Int128 exact = fits && a != 0 ? magnitude128(Int128{a}) << shift : Int128{0};
      expect_saturated(scaled, a < 0, exact, fits, count);
    } else {
      const long double exact = std::ldexp(static_cast<long double>(a), shift);
      RC_ASSERT(std::fabs(static_cast<long double>(scaled) - exact) <= 0.5L);
      RC_ASSERT(count == 0U);
    }
  }));
}

TEST(FixedProperty, RootsAreTheNearest) {
  EXPECT_TRUE(rc::check([] {
    const std::int64_t value = *operand();
    const int bits = *rc::gen::inRange(0, 60);
    const FixedRoot root = square_root(value, bits);
    if (value <= 0) {
      RC_ASSERT(root.mantissa == 0);
      return;
    }
    RC_ASSERT(root.mantissa >= 1 << 29);
    const long double exact = std::sqrt(std::ldexp(static_cast<long double>(value), -bits));
    const long double mantissa = std::ldexp(exact, root.bits);
    RC_ASSERT(std::fabs(static_cast<long double>(root.mantissa) - mantissa) <= 0.500001L);
  }));
}

TEST(FixedProperty, EveryAngleHasASineACosineAndBackAgain) {
  EXPECT_TRUE(rc::check([] {
    const auto angle = FixedAngle::from_raw(*rc::gen::arbitrary<std::int32_t>());
    FixedRatio sine;
    FixedRatio cosine;
    sin_cos(angle, sine, cosine);
    const auto exact = static_cast<long double>(angle.to_double());
    RC_ASSERT(std::fabs(static_cast<long double>(sine.to_double()) - std::sin(exact)) < 2e-9L);
    RC_ASSERT(std::fabs(static_cast<long double>(cosine.to_double()) - std::cos(exact)) < 2e-9L);
    const FixedAngle back = fixed_atan2(sine.raw(), cosine.raw());
    const std::int64_t turned = std::int64_t{back.raw()} - wrapped_angle(angle.raw()).raw();
    RC_ASSERT(std::abs(wrapped_angle(turned).raw()) <= 6);
  }));
}

}  // namespace
}  // namespace cairn
