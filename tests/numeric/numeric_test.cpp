#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/base/fixed_vector.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/numeric/positive_definite.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

template <class T>
struct Tolerance;
template <>
struct Tolerance<float> {
  static constexpr double kTrig = 3e-7;
  static constexpr double kRelative = 3e-7;
};
template <>
struct Tolerance<double> {
  static constexpr double kTrig = 6e-16;
  static constexpr double kRelative = 2e-15;
};

template <class T>
class Elementary : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(Elementary, Scalars, );

TYPED_TEST(Elementary, SineAndCosineAgreeWithLibm) {
  for (int i = -20000; i <= 20000; ++i) {
    const auto angle = static_cast<TypeParam>(i * 5e-4);
    TypeParam s{}, c{};
    sin_cos(angle, s, c);
    EXPECT_NEAR(s, std::sin(static_cast<double>(angle)), Tolerance<TypeParam>::kTrig) << angle;
    EXPECT_NEAR(c, std::cos(static_cast<double>(angle)), Tolerance<TypeParam>::kTrig) << angle;
  }
}

TYPED_TEST(Elementary, SineOfNonFiniteOrHugeAngleStaysFinite) {
  const TypeParam inputs[] = {std::numeric_limits<TypeParam>::infinity(),
                              std::numeric_limits<TypeParam>::quiet_NaN(), TypeParam(1e30)};
  for (const TypeParam x : inputs) {
    TypeParam s{}, c{};
    sin_cos(x, s, c);
    EXPECT_EQ(s, TypeParam(0));
    EXPECT_EQ(c, TypeParam(1));
  }
}

TYPED_TEST(Elementary, AtanAgreesWithLibmInAllQuadrants) {
  for (int i = 0; i < 3600; ++i) {
    const double a = i * 2 * kPi<double> / 3600 - 3.14;
    for (const double r : {1e-3, 1.0, 50.0}) {
      const auto y = static_cast<TypeParam>(r * std::sin(a));
      const auto x = static_cast<TypeParam>(r * std::cos(a));
      EXPECT_NEAR(atan2(y, x), std::atan2(static_cast<double>(y), static_cast<double>(x)),
                  2 * Tolerance<TypeParam>::kTrig);
    }
  }
  EXPECT_EQ(atan2(TypeParam(0), TypeParam(0)), TypeParam(0));
}

TYPED_TEST(Elementary, ExpAndLogAgreeWithLibm) {
  for (int i = -800; i <= 800; ++i) {
    const auto x = static_cast<TypeParam>(i * 0.1);
    const double want = std::exp(static_cast<double>(x));
    EXPECT_NEAR(exp(x) / want, 1.0, Tolerance<TypeParam>::kRelative) << x;
    const auto y = static_cast<TypeParam>(want);
    const double log_want = std::log(static_cast<double>(y));
    EXPECT_NEAR(log(y), log_want, Tolerance<TypeParam>::kRelative * (1 + std::fabs(log_want)));
  }
  EXPECT_EQ(exp(TypeParam(-1e5)), TypeParam(0));
  EXPECT_TRUE(is_finite(exp(TypeParam(1e5))));
  EXPECT_TRUE(is_finite(log(TypeParam(-1))));
}

TYPED_TEST(Elementary, WrappedAngleIsEquivalentAndInRange) {
  for (int i = -4000; i <= 4000; ++i) {
    const auto angle = static_cast<TypeParam>(i * 0.01);
    const TypeParam wrapped = wrap_angle(angle);
    EXPECT_GT(wrapped, -kPi<TypeParam> - TypeParam(1e-5));
    EXPECT_LE(wrapped, kPi<TypeParam>);
    EXPECT_NEAR(std::remainder(static_cast<double>(angle - wrapped), 2 * kPi<double>), 0.0, 2e-5);
  }
}

TYPED_TEST(Elementary, RoundingIsClampedBeforeConversion) {
  EXPECT_EQ(round_to_int(TypeParam(2.5)), 3);
  EXPECT_EQ(round_to_int(TypeParam(-2.5)), -2);
  EXPECT_EQ(round_to_int(TypeParam(1e20)), 1073741824);
  EXPECT_EQ(round_to_int(TypeParam(-1e20)), -1073741824);
  EXPECT_EQ(round_to_int(std::numeric_limits<TypeParam>::quiet_NaN()), 0);
}

TEST(IntegerSquareRoot, IsTheLargestThatFits) {
  EXPECT_EQ(integer_sqrt(0), 0U);
  EXPECT_EQ(integer_sqrt(std::numeric_limits<std::uint64_t>::max()), 0xFFFFFFFFU);
  for (int bit = 0; bit < 32; ++bit) {
    for (const std::uint64_t offset : {0U, 1U, 2U}) {
      const std::uint64_t root = (std::uint64_t{1} << bit) + offset;
      if (root > 0xFFFFFFFFU) continue;
      const std::uint64_t square = root * root;
      EXPECT_EQ(integer_sqrt(square), root);
      EXPECT_EQ(integer_sqrt(square - 1), root - 1);
    }
  }
}

class Packed : public ::testing::Test {
 protected:
  static constexpr int kN = 9;
  using Matrix = PackedSymmetric<double, 12>;

  Packed() {
    p_.resize(kN);
    for (int i = 0; i < kN; ++i) {
      for (int j = 0; j <= i; ++j) p_(i, j) = value(i, j);
    }
  }
  static double value(int i, int j) { return 100.0 * (i > j ? i : j) + (i > j ? j : i); }

  Matrix p_;
};

TEST_F(Packed, SparseProductEqualsDenseProduct) {
  const int columns[] = {1, 4, 8};
  const double h[] = {2.0, -3.0, 0.5};
  double out[kN];
  p_.multiply_sparse(columns, h, 3, out);
  for (int i = 0; i < kN; ++i) {
    EXPECT_DOUBLE_EQ(out[i], 2.0 * value(i, 1) - 3.0 * value(i, 4) + 0.5 * value(i, 8));
  }
}

TEST_F(Packed, TwoRankOneDowndatesEqualOneOfRankTwo) {
  double a[kN], b[kN];
  for (int i = 0; i < kN; ++i) {
    a[i] = 0.1 * i - 0.3;
    b[i] = 1.0 / (i + 1);
  }
  Matrix one = p_;
  one.downdate(a, 0.7);
  one.downdate(b, 0.2);
  p_.downdate(a, b, 0.7, 0.0, 0.2);
  for (int i = 0; i < kN; ++i) {
    for (int j = 0; j <= i; ++j) EXPECT_NEAR(p_(i, j), one(i, j), 1e-12);
  }
}

TEST_F(Packed, RemovingABlockMovesTheLastOneIntoItsPlace) {
  p_.remove_block_unordered(2, 2);
  const int origin[] = {0, 1, 7, 8, 4, 5, 6};
  ASSERT_EQ(p_.size(), 7);
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j <= i; ++j) EXPECT_EQ(p_(i, j), value(origin[i], origin[j])) << i << ' ' << j;
  }
}

TEST_F(Packed, RemovingABlockInOrderClosesTheGap) {
  p_.remove_block(3, 2);
  const int origin[] = {0, 1, 2, 5, 6, 7, 8};
  ASSERT_EQ(p_.size(), 7);
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j <= i; ++j) EXPECT_EQ(p_(i, j), value(origin[i], origin[j]));
  }
}

TEST_F(Packed, GrownRowsAreZero) {
  p_.resize(5);
  p_.resize(8);
  for (int i = 5; i < 8; ++i) {
    for (int j = 0; j <= i; ++j) EXPECT_EQ(p_(i, j), 0.0);
  }
}

TEST(SemidefiniteFactor, WhatHasNoVarianceVariesWithNothing) {
  const auto semidefinite = [](float first, float between, float second) {
    PackedSymmetric<float, 2> a;
    a.resize(2);
    a(0, 0) = first;
    a(1, 0) = between;
    a(1, 1) = second;
    return factor_semidefinite(a);
  };
  EXPECT_TRUE(semidefinite(0.0F, 0.0F, 2.0F));
  EXPECT_TRUE(semidefinite(4.0F, 0.0F, 0.0F));
  EXPECT_TRUE(semidefinite(1.0F, 1.0F, 1.0F));
  EXPECT_FALSE(semidefinite(0.0F, 24.0F, 1.2F));
  EXPECT_FALSE(semidefinite(1.2F, 24.0F, 0.0F));
  EXPECT_FALSE(semidefinite(-1.0F, 0.0F, 2.0F));
}

TEST(FixedVector, RefusesBeyondCapacity) {
  FixedVector<int, 2> v;
  EXPECT_TRUE(v.push_back(1));
  EXPECT_TRUE(v.push_back(2));
  EXPECT_FALSE(v.push_back(3));
  EXPECT_EQ(v.size(), 2);
  v.remove_unordered(0);
  EXPECT_EQ(v[0], 2);
}

TEST(Random, SequenceDependsOnTheSeedAloneAndIsUniform) {
  Random a(42), b(42), c(43);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const auto x = a.next();
    EXPECT_EQ(x, b.next());
    differs = differs || x != c.next();
  }
  EXPECT_TRUE(differs);
  int counts[6] = {};
  for (int i = 0; i < 60000; ++i) ++counts[a.below(6)];
  for (const int n : counts) EXPECT_NEAR(n, 10000, 500);
}

}  // namespace
}  // namespace cairn
