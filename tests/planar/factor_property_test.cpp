// The factor of the covariance for any rows, against integers of 128 bits.
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "cairn/planar/fixed/row_scaled_factor.hpp"

#include "any_integer.hpp"

namespace cairn {
namespace {

constexpr int kRows = 6;
using Factor = RowScaledFactor<kRows>;

/// Of the rows' mantissas, exact: bits(i) + bits(k) of it are its fraction.
Int128 product_of(const Factor& S, int i, int k) {
  Int128 sum = 0;
  for (int j = 0; j <= (i < k ? i : k); ++j) sum += Int128{S.at(i, j)} * S.at(k, j);
  return sum;
}
double length_of(const Factor& S, int i) {
  return std::sqrt(static_cast<double>(product_of(S, i, i)));
}

/// GIVEN a factor of any rows with room for noise as large as they are.
Factor any_factor() {
  Factor S;
  std::uint32_t count = 0;
  for (int i = 0; i < kRows; ++i) {
    std::int64_t row[kRows];
    for (int j = 0; j <= i; ++j) row[j] = *operand_of(30);
    S.append(
        *rc::gen::inRange(24, 44), [&](int j) { return row[j]; }, count, 2);
    S.make_room(i, -2 * S.bits(i) + 57, count);
  }
  return S;
}

TEST(FactorProperty, CovariancesAreTheNearest) {
  EXPECT_TRUE(rc::check([] {
    const Factor S = any_factor();
    for (int i = 0; i < kRows; ++i) {
      for (int k = 0; k <= i; ++k) {
        std::uint32_t count = 0;
        const std::int64_t result = S.covariance(i, k, count);
        const int shift = S.bits(i) + S.bits(k) - 44;
        const Int128 exact = product_of(S, i, k);
        RC_ASSERT(count == 0U);
        if (shift <= 0) {
          RC_ASSERT(Int128{result} == exact << -shift);
        } else {
          RC_ASSERT(magnitude128((Int128{result} << shift) - exact) <= Int128{1} << (shift - 1));
        }
      }
    }
  }));
}

/// Row and noise together have 58 to 60 bits of square, unless the finest scale has fewer.
TEST(FactorProperty, ScalesFollowTheRowAndItsNoise) {
  EXPECT_TRUE(rc::check([] {
    Factor S = any_factor();
    const int row = *rc::gen::inRange(0, kRows);
    const int noise = *rc::gen::inRange(-90, 20);
    std::uint32_t count = 0;
    RC_ASSERT(S.make_room(row, noise, count));
    RC_ASSERT(count == 0U);
    const int bits = S.bits(row);
    const int added = noise + 2 * bits;
    const Int128 total = product_of(S, row, row) + (Int128{1} << (added > 0 ? added : 0));
    RC_ASSERT(total <= Int128{1} << 60);
    RC_ASSERT(bits == Factor::kMostBits || total >= Int128{1} << 57);
  }));
}

/// P + v v^T to 1e-8 of both deviations, and a few units.
TEST(FactorProperty, AbsorbsAVector) {
  EXPECT_TRUE(rc::check([] {
    Factor S = any_factor();
    std::int32_t v[kRows];
    for (std::int32_t& part : v) part = static_cast<std::int32_t>(*operand_of(28));
    Int128 expected[kRows][kRows];
    double length[kRows];
    for (int i = 0; i < kRows; ++i) {
      for (int k = 0; k <= i; ++k) expected[i][k] = product_of(S, i, k) + Int128{v[i]} * v[k];
      length[i] = std::sqrt(static_cast<double>(expected[i][i])) + 1.0;
    }
    S.absorb(v, 0);
    for (int i = 0; i < kRows; ++i) {
      RC_ASSERT(length_of(S, i) < std::ldexp(1.0, 30));
      for (int k = 0; k <= i; ++k) {
        const auto error = static_cast<double>(magnitude128(product_of(S, i, k) - expected[i][k]));
        RC_ASSERT(error <= 4e-8 * length[i] * length[k] + 12.0 * (length[i] + length[k]));
      }
    }
  }));
}

/// The innovation's variance is that of the row and its noise, and no deviation grows.
TEST(FactorProperty, ConditionsOnAMeasurement) {
  EXPECT_TRUE(rc::check([] {
    Factor S = any_factor();
    std::int32_t a[kRows];
    for (std::int32_t& part : a) part = static_cast<std::int32_t>(*operand_of(28));
    auto sigma = static_cast<std::int32_t>(1 + magnitude128(*operand_of(28)));
    Int128 innovation = Int128{sigma} * sigma;
    for (const std::int32_t part : a) innovation += Int128{part} * part;
    double before[kRows];
    Int128 with[kRows];
    for (int i = 0; i < kRows; ++i) {
      before[i] = length_of(S, i);
      with[i] = 0;
      for (int j = 0; j <= i; ++j) with[i] += Int128{S.at(i, j)} * a[j];
    }
    std::int32_t gain[kRows];
    S.condition(a, kRows - 1, sigma, gain);
    const double s = std::sqrt(static_cast<double>(innovation));
    RC_ASSERT(std::fabs(sigma - s) <= 2e-8 * s + 8.0);
    for (int i = 0; i < kRows; ++i) {
      const double exact = static_cast<double>(with[i]) / s;
      // What rounding of sigma and of the rows makes of a gain: a few units of both.
      RC_ASSERT(std::fabs(gain[i] - exact) <= 4e-8 * before[i] + 12.0 * (1.0 + before[i] / s));
      const double left = length_of(S, i);
      RC_ASSERT(left <= before[i] * (1.0 + 2e-8) + 8.0);
      const double kept = std::sqrt(left * left + std::pow(gain[i], 2.0));
      RC_ASSERT(std::fabs(kept - before[i]) <= 4e-8 * before[i] + 12.0);
    }
  }));
}

TEST(FactorProperty, WhatIsLeftKeepsItsCovariance) {
  EXPECT_TRUE(rc::check([] {
    Factor S = any_factor();
    const int first = *rc::gen::inRange(0, kRows - 1);
    const Factor before = S;
    std::int32_t scratch[2 * kRows] = {};
    S.remove_rows<2>(first, scratch);
    RC_ASSERT(S.size() == kRows - 2);
    for (int i = 0; i < kRows - 2; ++i) {
      for (int k = 0; k <= i; ++k) {
        const int from_i = i < first ? i : i + 2;
        const int from_k = k < first ? k : k + 2;
        const double size = length_of(before, from_i) + 1.0;
        const double other = length_of(before, from_k) + 1.0;
        const Int128 off = product_of(S, i, k) - product_of(before, from_i, from_k);
        RC_ASSERT(static_cast<double>(magnitude128(off)) <=
                  8e-8 * size * other + 24.0 * (size + other));
      }
    }
  }));
}

}  // namespace
}  // namespace cairn
