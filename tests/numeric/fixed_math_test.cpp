#include "cairn/numeric/fixed_math.hpp"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

using Small = Fixed<std::int32_t, 20>;

std::int64_t bits64(Random& random) {
  const std::uint64_t high = random.next();
  return static_cast<std::int64_t>((high << 32U) | random.next());
}

TEST(Fixed, ConstantsAreTheNearestAndSaturate) {
  EXPECT_EQ(Small::nearest(1.5).raw(), 3 << 19);
  EXPECT_EQ(Small::nearest(-1.4e-6).raw(), -1);
  EXPECT_EQ(Small::nearest(1e9).raw(), INT32_MAX);
  EXPECT_EQ(Small::nearest(-1e9).raw(), -INT32_MAX);
  EXPECT_EQ(Small::nearest(std::nan("")).raw(), 0);
  EXPECT_EQ((-Small::from_raw(INT32_MIN)).raw(), INT32_MAX);
}

TEST(Fixed, OverflowSaturatesAndIsCounted) {
  std::uint32_t count = 0;
  EXPECT_EQ(add(Small::most(), Small::from_raw(1), count), Small::most());
  EXPECT_EQ(subtract(-Small::most(), Small::from_raw(1), count), -Small::most());
  EXPECT_EQ(multiply<Small>(Small::most(), -Small::most(), count), -Small::most());
  EXPECT_EQ((convert<Fixed<std::int32_t, 28>>(Small::nearest(9.0), count).raw()), INT32_MAX);
  EXPECT_EQ(count, 4U);
  EXPECT_EQ(add(Small::most(), Small::from_raw(-1), count).raw(), INT32_MAX - 1);
  EXPECT_EQ(count, 4U);
}

TEST(Fixed, DivisionByZeroSaturatesAndIsCounted) {
  std::uint32_t count = 0;
  EXPECT_EQ(divide<Small>(Small::from_raw(5), Small(), count), Small::most());
  EXPECT_EQ(divide<Small>(Small::from_raw(-5), Small(), count), -Small::most());
  EXPECT_EQ(count, 4U);  // the quotient and the format, each time
  EXPECT_EQ(divide<Small>(Small(), Small(), count), Small());
  EXPECT_EQ(count, 5U);
}

TEST(FixedMath, SineAndCosineAreWithinTheirError) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const auto angle = FixedAngle::from_raw(static_cast<std::int32_t>(random.next()));
    FixedRatio sine;
    FixedRatio cosine;
    sin_cos(angle, sine, cosine);
    ASSERT_NEAR(sine.to_double(), std::sin(angle.to_double()), 2e-9);
    ASSERT_NEAR(cosine.to_double(), std::cos(angle.to_double()), 2e-9);
  }
}

TEST(FixedMath, AtanIsWithinItsErrorForVectorsOfAnyLength) {
  Random random(2);
  for (int i = 0; i < 20000; ++i) {
    const std::int64_t y = bits64(random) >> random.below(63);
    const std::int64_t x = bits64(random) >> random.below(63);
    const double expected = std::atan2(static_cast<double>(y), static_cast<double>(x));
    const double error = fixed_atan2(y, x).to_double() - expected;
    ASSERT_NEAR(wrap_angle(error), 0.0, 1.5e-8);
  }
  EXPECT_EQ(fixed_atan2(std::int64_t{0}, std::int64_t{0}).raw(), 0);
  EXPECT_EQ(fixed_atan2(std::int64_t{0}, std::int64_t{INT64_MIN}), kFixedPi);
}

TEST(FixedMath, AnglesWrapToTheHalfOpenTurn) {
  EXPECT_NEAR(wrapped_angle(-std::int64_t{kFixedPi.raw()}).raw(), kFixedPi.raw(), 1);
  EXPECT_EQ(wrapped_angle(kFixedPi.raw()), kFixedPi);
  for (const double angle : {3.5, -4.0, 7.0, 1e4, -1e4}) {
    const auto raw = static_cast<std::int64_t>(angle * (1 << FixedAngle::kFractionBits));
    EXPECT_NEAR(wrapped_angle(raw).to_double(), wrap_angle(angle), 1e-5) << angle;
  }
  const FixedAngle least = wrapped_angle(INT64_MIN);
  EXPECT_TRUE(least <= kFixedPi && least > -kFixedPi);
}

TEST(FixedMath, ExponentialIsWithinItsError) {
  const double unit = std::pow(2.0, -44);
  for (int i = 0; i < 4000; ++i) {
    const std::int64_t x = (std::int64_t{i} * i) << 24;
    ASSERT_NEAR(static_cast<double>(exp_negative_44(x)) * unit,
                std::exp(-static_cast<double>(x) * unit), 1e-12);
  }
  EXPECT_EQ(exp_negative_44(-1), std::int64_t{1} << 44);
  EXPECT_EQ(exp_negative_44(INT64_MAX), 0);
}

TEST(FixedMath, RotationsAreOrthogonalAndPointWhereTheyShould) {
  Random random(3);
  double bias = 0.0;
  constexpr int kTries = 20000;
  for (int i = 0; i < kTries; ++i) {
    const auto a = static_cast<std::int32_t>(random.next()) >> (1 + random.below(28));
    const auto b = static_cast<std::int32_t>(random.next()) >> (1 + random.below(28));
    if (a == 0 && b == 0) continue;
    const PlaneRotation by = rotation_onto(a, b);
    const double unit = std::pow(2.0, -30);
    const double r = std::sqrt(std::pow(a, 2.0) + std::pow(b, 2.0));
    ASSERT_NEAR(by.cosine * unit, a / r, 2.5e-9);
    ASSERT_NEAR(by.sine * unit, b / r, 2.5e-9);
    bias += std::pow(by.cosine * unit, 2.0) + std::pow(by.sine * unit, 2.0) - 1.0;
  }
  // A million rotations change a length by less than a thousandth.
  EXPECT_NEAR(bias / kTries, 0.0, 1e-9);
  EXPECT_EQ(rotation_onto(0, 0).cosine, 1 << 30);
}

TEST(FixedMath, TurningLeavesAZeroAndTheLength) {
  std::int32_t a[2] = {300000000, -77};
  std::int32_t b[2] = {-400000000, 1 << 29};
  const PlaneRotation by = rotation_onto(a[0], b[0]);
  rotate(by, a, b, 2);
  EXPECT_NEAR(a[0], 500000000, 2);
  EXPECT_NEAR(b[0], 0, 2);
  EXPECT_NEAR(std::sqrt(std::pow(a[1], 2.0) + std::pow(b[1], 2.0)), 536870912.0, 3.0);
}

}  // namespace
}  // namespace cairn
