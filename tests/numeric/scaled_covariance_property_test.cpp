// A covariance in mantissas and scales for any calls, against integers of 128 bits.
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "cairn/numeric/scaled_covariance.hpp"

#include "any_integer.hpp"

namespace cairn {
namespace {

constexpr int kStates = 5;
using Covariance = ScaledCovariance<kStates>;

long double value_of(const Covariance& P, int i, int j) {
  return std::ldexp(static_cast<long double>(P.mantissa(i, j)), -P.scale(i) - P.scale(j));
}

bool is_sound(const Covariance& P) {
  for (int i = 0; i < kStates; ++i) {
    const std::int32_t variance = P.variance(i);
    if (variance != 0 && (variance < 1 << 26 || variance >= Covariance::kMost)) return false;
  }
  return true;
}

TEST(ScaledCovarianceProperty, VariancesAreKeptTo26Bits) {
  EXPECT_TRUE(rc::check([] {
    Covariance P;
    std::uint32_t count = 0;
    long double sum = 0.0L;
    for (int k = 0; k < 4; ++k) {
      const std::int64_t value = *operand_of(60);
      const int bits = *rc::gen::inRange(20, 60);
      RC_PRE(value > 0);
      P.add_variance(2, value, bits, count);
      const long double added = std::ldexp(static_cast<long double>(value), -bits);
      sum += added;
      RC_ASSERT(count > 0U || std::fabs(value_of(P, 2, 2) - sum) <= std::ldexp(sum, -26) * (k + 1));
      RC_ASSERT(is_sound(P));
      if (count > 0U) return;
    }
  }));
}

/// P loses a a^T + b b^T to half a unit of each element, in the scale before.
TEST(ScaledCovarianceProperty, LosesTheSquaresOfTwoVectors) {
  EXPECT_TRUE(rc::check([] {
    Covariance P;
    for (int i = 0; i < kStates; ++i) {
      const std::int64_t value = *operand_of(40);
      if (value > 0) P.set_variance(i, value, *rc::gen::inRange(0, 60));
    }
    if (P.variance(1) != 0) P.copy_state(1, 4);
    for (int round = 0; round < 6; ++round) {
      const Covariance before = P;
      std::uint8_t states[kStates];
      std::int32_t a[kStates] = {};
      std::int32_t b[kStates] = {};
      const int count = P.active(states);
      for (int p = 0; p < count; ++p) {
        a[p] = static_cast<std::int32_t>(*operand_of(29));
        b[p] = static_cast<std::int32_t>(*operand_of(29));
        while (!P.leaves_variance(states[p], a[p], b[p])) {
          a[p] /= 2;
          b[p] /= 2;
        }
      }
      P.downdate(states, count, a, b);
      RC_ASSERT(is_sound(P));
      for (int p = 0; p < count; ++p) {
        for (int q = 0; q <= p; ++q) {
          const int i = states[p];
          const int j = states[q];
          const int grown = P.scale(i) - before.scale(i) + P.scale(j) - before.scale(j);
          RC_ASSERT(grown >= 0);
          const Int128 left =
              (Int128{before.mantissa(i, j)} << 30) - Int128{a[p]} * a[q] - Int128{b[p]} * b[q];
          const Int128 exact = left << grown;
          const Int128 result = Int128{P.mantissa(i, j)} << 30;
          const Int128 unit = Int128{1} << (30 + grown);
          const Int128 most = (Int128{Covariance::kMost} << 30) - unit;
          const bool limited = magnitude128(exact) >= most;
          RC_ASSERT(limited || magnitude128(result - exact) <= (i == j ? unit : unit / 2));
          if (limited) RC_ASSERT((result > 0) == (exact > 0));
        }
      }
    }
  }));
}

TEST(ScaledCovarianceProperty, ACopyIsTheSameQuantity) {
  EXPECT_TRUE(rc::check([] {
    Covariance P;
    const std::int64_t value = *operand_of(60);
    RC_PRE(value > 0);
    P.set_variance(0, value, *rc::gen::inRange(0, 60));
    P.copy_state(0, 3);
    RC_ASSERT(P.mantissa(3, 0) == P.variance(0));
    RC_ASSERT(P.variance(3) == P.variance(0));
    RC_ASSERT(P.scale(3) == P.scale(0));
    P.clear_state(0);
    RC_ASSERT(P.mantissa(3, 0) == 0);
    RC_ASSERT(P.variance(0) == 0);
  }));
}

}  // namespace
}  // namespace cairn
