// Formats and what turns one into another, for any operands, against integers of 128 bits.
#include <algorithm>
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "cairn/numeric/fixed_math.hpp"
#include "cairn/numeric/float_bits.hpp"
#include "cairn/numeric/reciprocal.hpp"

#include "any_integer.hpp"

namespace cairn {
namespace {

using Short = Fixed<std::int32_t, 24>;
using Wide = Fixed<std::int64_t, 32>;
using Unit = Fixed<std::int32_t, 30>;

/// |result - exact / 2^shift| is at most half a unit of the result, and one that does not fit is
/// the largest of its sign, counted.
template <class S, int F>
void expect_nearest(Fixed<S, F> result, Int128 exact, int shift, const std::uint32_t& count) {
  const Int128 raw = result.raw();
  const Int128 half = shift > 0 ? Int128{1} << (shift - 1) : Int128{0};
  const Int128 most = Fixed<S, F>::most().raw();
  if (magnitude128(exact) > (most << shift) + half) {
    RC_ASSERT(raw == (exact < 0 ? -most : most));
    RC_ASSERT(count > 0U);
  } else {
    RC_ASSERT(magnitude128((raw << shift) - exact) <= half);
  }
  if (magnitude128(exact) + half <= most << shift) RC_ASSERT(count == 0U);
}

Short any_short() {
  return Short::from_raw(static_cast<std::int32_t>(*operand_of(31)));
}
Wide any_wide() {
  return Wide::from_raw(*operand_of(62));
}
Unit any_unit() {
  return Unit::from_raw(static_cast<std::int32_t>(*operand_of(31)));
}

TEST(FixedFormatsProperty, ProductsOfTwoFormatsAreTheNearest) {
  EXPECT_TRUE(rc::check([] {
    const Short a = any_short();
    const Wide b = any_wide();
    const Unit c = any_unit();
    std::uint32_t count = 0;
    expect_nearest(multiply<Short>(a, c, count), Int128{a.raw()} * c.raw(), 30, count);
    count = 0;
    expect_nearest(multiply<Wide>(a, c, count), Int128{a.raw()} * c.raw(), 22, count);
    count = 0;
    expect_nearest(multiply<Wide>(b, c, count), Int128{b.raw()} * c.raw(), 30, count);
    count = 0;
    expect_nearest(multiply<Short>(b, c, count), Int128{b.raw()} * c.raw(), 38, count);
  }));
}

TEST(FixedFormatsProperty, SumsAndOtherFormatsAreTheNearest) {
  EXPECT_TRUE(rc::check([] {
    const Short a = any_short();
    const Short b = any_short();
    const Wide wide = any_wide();
    std::uint32_t count = 0;
    expect_nearest(add(a, b, count), Int128{a.raw()} + b.raw(), 0, count);
    count = 0;
    expect_nearest(subtract(a, b, count), Int128{a.raw()} - b.raw(), 0, count);
    count = 0;
    expect_nearest(convert<Wide>(a, count), Int128{a.raw()} << 8, 0, count);
    count = 0;
    expect_nearest(convert<Short>(wide, count), wide.raw(), 8, count);
    RC_ASSERT((-a).raw() == -a.raw());
  }));
}

TEST(FixedFormatsProperty, QuotientsOfTwoFormatsAreTheNearest) {
  EXPECT_TRUE(rc::check([] {
    const Short a = any_short();
    const Wide b = any_wide();
    RC_PRE(b.raw() != 0);
    std::uint32_t count = 0;
    const Short result = divide<Short>(a, b, count);
    // a / b with 24 fraction bits is a 2^32 / b.
    const Int128 exact = Int128{a.raw()} << 32;
    const Int128 divisor = magnitude128(b.raw());
    if (2 * magnitude128(exact) >= (Int128{INT32_MAX} * 2 + 1) * divisor) {
      RC_ASSERT(count == 1U);
      RC_ASSERT(std::abs(result.raw()) == INT32_MAX);
    } else {
      RC_ASSERT(count == 0U);
      RC_ASSERT(2 * magnitude128(Int128{result.raw()} * b.raw() - exact) <= divisor);
    }
  }));
}

TEST(FixedFormatsProperty, ReciprocalsDivide) {
  EXPECT_TRUE(rc::check([] {
    const auto value = static_cast<std::int32_t>(magnitude128(*operand_of(31)));
    const auto x = static_cast<std::int32_t>(*operand_of(31));
    const int fraction = *rc::gen::inRange(0, 31);
    RC_PRE(value > 0);
    const Int128 result = Reciprocal(value).times(x, fraction);
    const Int128 exact = Int128{x} << fraction;
    // Half a unit, and four 2^-29 of the quotient.
    const Int128 error = magnitude128(result * value - exact);
    RC_ASSERT(2 * error <= value + (magnitude128(exact) >> 26) + 2);
  }));
}

TEST(FixedFormatsProperty, FloatsBecomeTheNearestAndComeBack) {
  EXPECT_TRUE(rc::check([] {
    const auto bits = *rc::gen::arbitrary<std::uint32_t>();
    float value = 0.0F;
    std::memcpy(&value, &bits, sizeof value);
    std::uint32_t count = 0;
    const Short fixed = fixed_of<Short>(value, count);
    if (!std::isfinite(value)) {
      RC_ASSERT(count > 0U);
      return;
    }
    const long double scaled = std::ldexp(static_cast<long double>(value), 24);
    const bool fits = std::fabs(scaled) < static_cast<long double>(INT32_MAX);
    RC_ASSERT((count == 0U) == fits);
    if (fits) {
      RC_ASSERT(std::fabs(static_cast<long double>(fixed.raw()) - scaled) <= 0.5L);
    } else {
      RC_ASSERT(fixed.raw() == (value < 0.0F ? -INT32_MAX : INT32_MAX));
    }
    const Wide any = any_wide();
    RC_ASSERT(float_of(any) == std::ldexp(static_cast<float>(any.raw()), -32));
  }));
}

TEST(FixedFormatsProperty, TurnsKeepLengths) {
  EXPECT_TRUE(rc::check([] {
    const auto part = [](int bits) { return static_cast<std::int32_t>(*operand_of(bits)); };
    const PlaneRotation by = rotation_onto(part(30), part(30));
    std::int32_t a = part(29);
    std::int32_t b = part(29);
    const Int128 before = Int128{a} * a + Int128{b} * b;
    rotate(by, &a, &b, 1);
    const Int128 after = Int128{a} * a + Int128{b} * b;
    // 5e-9 of the square, and a unit of each part.
    const auto longest = static_cast<std::int64_t>(std::sqrt(static_cast<double>(before))) + 2;
    RC_ASSERT(magnitude128(after - before) <= before / 200000000 + 4 * Int128{longest});
  }));
}

TEST(FixedFormatsProperty, TurnsAreTheNearestAndMakeNothingOfNothing) {
  EXPECT_TRUE(rc::check([] {
    const auto part = [](int bits) { return static_cast<std::int32_t>(*operand_of(bits)); };
    const PlaneRotation by = rotation_onto(part(30), part(30));
    // Rounding may leave a factor a little beyond 1, which counts as 1.
    constexpr std::int32_t kOne = 1 << 30;
    const Int128 cosine = std::clamp(by.cosine, -kOne, kOne);
    const Int128 sine = std::clamp(by.sine, -kOne, kOne);
    const std::int32_t x = part(29);
    const std::int32_t y = part(29);
    const auto off = [](std::int32_t result, Int128 exact) {
      return magnitude128((Int128{result} << 30) - exact);
    };
    // Half a unit, and what a factor of 1 is less by.
    constexpr Int128 kUnit = (Int128{1} << 29) + (Int128{1} << 28);
    std::int32_t a[2] = {x, 0};
    std::int32_t b[2] = {y, 0};
    rotate(by, a, b, 2);
    RC_ASSERT(off(a[0], cosine * x + sine * y) <= kUnit);
    RC_ASSERT(off(b[0], cosine * y - sine * x) <= kUnit);
    RC_ASSERT(a[1] == 0 && b[1] == 0);
    std::int32_t from[1] = {x};
    std::int32_t only[1] = {y};
    turn_from_nothing(by, from, only, 1);
    RC_ASSERT(off(from[0], Int128{by.sine} * y) <= Int128{1} << 29);
    RC_ASSERT(off(only[0], Int128{by.cosine} * y) <= Int128{1} << 29);
  }));
}

}  // namespace
}  // namespace cairn
