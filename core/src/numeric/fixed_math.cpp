#include "cairn/numeric/fixed_math.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr std::int64_t kHalfPi32 = 6746518852;  // pi / 2 in 2^-32
constexpr std::int64_t kTwoPi28 = 1686629713;   // 2 pi in 2^-28

constexpr std::int32_t q30(double value) {
  return Fixed<std::int32_t, 30>::nearest(value).raw();
}
/// a b with 30 fraction bits each, and in the product.
std::int32_t times(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(wide::round_shift_far(std::int64_t{a} * b, 30));
}

/// 2^15 / sqrt(m) at the middles of the 192 intervals of width 1/64 from 1 to 4: two Newton steps
/// from there are right to 8e-10.
struct RootTable {
  std::uint16_t seeds[192] = {};
  constexpr RootTable() {
    for (int k = 0; k < 192; ++k) {
      const std::uint64_t middle = 129 + 2 * static_cast<std::uint64_t>(k);  // of 128
      // Largest s with s^2 m <= 2^30.
      std::uint64_t s = 0;
      for (std::uint64_t bit = 1U << 15U; bit > 0; bit >>= 1U) {
        if ((s + bit) * (s + bit) * middle <= std::uint64_t{1} << 37U) s += bit;
      }
      seeds[k] = static_cast<std::uint16_t>(s);
    }
  }
};
constexpr RootTable kRootTable;

/// y (3 - m y^2) / 2, a Newton step to 1 / sqrt(m), of a y with 31 fraction bits and its square
/// with 30.
std::uint32_t root_step(std::uint32_t m, std::uint32_t y, std::uint32_t squared) {
  const auto product =
      static_cast<std::uint32_t>((std::uint64_t{m} * squared + (1U << 29U)) >> 30U);
  const std::uint32_t factor = (3U << 30U) - product;
  return static_cast<std::uint32_t>((std::uint64_t{y} * factor + (1U << 30U)) >> 31U);
}

/// 2^31 / sqrt(m / 2^30) of m in [2^30, 2^32), below 2^31.
std::int32_t inverse_root(std::uint32_t m) {
  const std::uint32_t seed = kRootTable.seeds[(m >> 24U) - 64];
  std::uint32_t y = root_step(m, seed << 16U, seed * seed);
  y = root_step(m, y, static_cast<std::uint32_t>((std::uint64_t{y} * y + (1U << 31U)) >> 32U));
  return y > INT32_MAX ? INT32_MAX : static_cast<std::int32_t>(y);
}

/// A factor near [-1, 1] with 31 fraction bits instead of 30.
constexpr std::int32_t with_31_bits(std::int32_t factor) {
  constexpr std::int32_t kOne = 1 << 30;
  if (factor >= kOne) return INT32_MAX;
  return factor < -kOne ? INT32_MIN : 2 * factor;
}

constexpr int kRootCorrections = 8;

constexpr int kAtanSteps = 14;  // then the angle left is below 2^-13, and its own tangent
/// atan(2^-k) with 29 fraction bits.
struct AtanTable {
  std::int32_t angles[kAtanSteps] = {};
  constexpr AtanTable() {
    for (int k = 0; k < kAtanSteps; ++k) {
      double t = 1.0;
      for (int i = 0; i < k; ++i) t *= 0.5;
      // atan(1) by Machin's formula, the others by their series.
      const double angle = k == 0 ? 4.0 * series(0.2) - series(1.0 / 239.0) : series(t);
      angles[k] = Fixed<std::int32_t, 29>::nearest(angle).raw();
    }
  }
  static constexpr double series(double t) {
    double sum = 0.0;
    double power = t;
    for (int n = 0; n < 30; ++n) {
      sum += (n % 2 == 0 ? power : -power) / (2 * n + 1);
      power *= t * t;
    }
    return sum;
  }
};
constexpr AtanTable kAtanTable;

}  // namespace

void sin_cos(FixedAngle angle, FixedRatio& sine, FixedRatio& cosine) {
  // Nearest multiple of a right angle: at most 5 of them.
  constexpr std::int64_t kPerTurn = 683565276;  // 2 / pi in 2^-30
  const auto quarter =
      static_cast<int>(wide::round_shift(std::int64_t{angle.raw()} * kPerTurn, 58));
  const std::int64_t rest = std::int64_t{angle.raw()} * 16 - quarter * kHalfPi32;  // 2^-32
  const auto r = static_cast<std::int32_t>(wide::round_shift(rest, 2));
  const std::int32_t x = times(r, r);
  std::int32_t s = q30(-1.0 / 39916800.0);
  s = q30(1.0 / 362880.0) + times(x, s);
  s = q30(-1.0 / 5040.0) + times(x, s);
  s = q30(1.0 / 120.0) + times(x, s);
  s = q30(-1.0 / 6.0) + times(x, s);
  s = r + times(r, times(x, s));
  std::int32_t c = q30(-1.0 / 3628800.0);
  c = q30(1.0 / 40320.0) + times(x, c);
  c = q30(-1.0 / 720.0) + times(x, c);
  c = q30(1.0 / 24.0) + times(x, c);
  c = q30(-0.5) + times(x, c);
  c = q30(1.0) + times(x, c);
  const bool swapped = quarter % 2 != 0;
  const int turn = quarter & 3;
  const std::int32_t first = swapped ? c : s;
  const std::int32_t second = swapped ? s : c;
  sine = FixedRatio::from_raw(turn >= 2 ? -first : first);
  cosine = FixedRatio::from_raw(turn == 1 || turn == 2 ? -second : second);
}

FixedAngle fixed_atan2(std::int64_t y, std::int64_t x) {
  if (x == 0 && y == 0) return {};
  // To 29 bits: the vector grows by 1.65 on its way to the x axis.
  const std::uint64_t larger =
      wide::magnitude(x) > wide::magnitude(y) ? wide::magnitude(x) : wide::magnitude(y);
  const int shift = 29 - wide::bit_length(larger);
  std::uint32_t none = 0;
  auto a = static_cast<std::int32_t>(wide::scale(x, shift, none));
  auto b = static_cast<std::int32_t>(wide::scale(y, shift, none));
  std::int32_t angle = 0;  // 2^-29
  constexpr std::int32_t kPi29 = Fixed<std::int32_t, 29>::nearest(kPi<double>).raw();
  if (a < 0) {
    angle = b >= 0 ? kPi29 : -kPi29;
    a = -a;
    b = -b;
  }
  for (int k = 0; k < kAtanSteps; ++k) {
    const auto up = static_cast<std::int32_t>(wide::round_shift(a, k));
    const auto across = static_cast<std::int32_t>(wide::round_shift(b, k));
    const bool left = b > 0;
    a += left ? across : -across;
    b -= left ? up : -up;
    angle += left ? kAtanTable.angles[k] : -kAtanTable.angles[k];
  }
  angle += static_cast<std::int32_t>(wide::divide(b, a, 29, none));
  const auto result = static_cast<std::int32_t>(wide::round_shift(angle, 1));
  return FixedAngle::from_raw(result <= -kFixedPi.raw() ? kFixedPi.raw() : result);
}

FixedAngle wrapped_angle(std::int64_t angle_raw) {
  const std::int64_t pi = kFixedPi.raw();
  if (angle_raw > -pi && angle_raw <= pi) {
    return FixedAngle::from_raw(static_cast<std::int32_t>(angle_raw));
  }
  std::int64_t rest = angle_raw % kTwoPi28;
  if (rest > pi) rest -= kTwoPi28;
  if (rest <= -pi) rest += kTwoPi28;
  if (rest > pi) rest = pi;
  return FixedAngle::from_raw(static_cast<std::int32_t>(rest));
}

std::int64_t exp_negative_44(std::int64_t x) {
  constexpr int kBits = 44;
  constexpr std::int64_t kOne = std::int64_t{1} << kBits;
  constexpr std::int64_t kLn2 = 12193974156573;  // ln 2 in 2^-44
  constexpr int kTerms = 16;
  if (x <= 0) return kOne;
  if (x >= 32 * kOne) return 0;
  const auto halvings = static_cast<int>(x / kLn2);
  const std::int64_t r = x - halvings * kLn2;
  std::uint32_t none = 0;
  std::int64_t sum = kOne;
  for (int n = kTerms; n > 0; --n) sum = kOne - wide::multiply(sum, r, kBits, none) / n;
  return wide::round_shift(sum, halvings);
}

FixedRoot square_root(std::int64_t value, int bits) {
  if (value <= 0) return {};
  int shift = 61 - wide::bit_length(static_cast<std::uint64_t>(value));
  if ((bits + shift) % 2 != 0) --shift;
  const std::uint64_t scaled = shift >= 0
                                   ? static_cast<std::uint64_t>(value) << shift
                                   : static_cast<std::uint64_t>(wide::round_shift(value, -shift));
  // scaled = m 2^(2 half): its root by the inverse's, right to two units.
  const int half = (wide::bit_length(scaled) - 1) / 2 - 15;
  const std::uint32_t m = static_cast<std::uint32_t>(scaled >> (2 * half));
  const std::uint64_t product = std::uint64_t{m} * static_cast<std::uint32_t>(inverse_root(m));
  std::uint64_t root = product >> (46 - half);
  for (int i = 0; i < kRootCorrections && root * root > scaled; ++i) --root;
  for (int i = 0; i < kRootCorrections && (root + 1) * (root + 1) <= scaled; ++i) ++root;
  FixedRoot result;
  result.mantissa = static_cast<std::int32_t>(scaled - root * root > root ? root + 1 : root);
  result.bits = (bits + shift) / 2;
  return result;
}

PlaneRotation rotation_onto(std::int32_t a, std::int32_t b) {
  if (b == 0 && a >= 0) return {};
  // Of the longer one 30 bits: the square of both lies in [2^58, 2^61).
  const auto longer = static_cast<std::uint32_t>(wide::magnitude(a) | wide::magnitude(b));
  const int doublings = __builtin_clz(longer) - 2;
  if (doublings < 0) {
    a /= 2;
    b /= 2;
  } else {
    a *= std::int32_t{1} << doublings;
    b *= std::int32_t{1} << doublings;
  }
  const std::uint64_t squared = static_cast<std::uint64_t>(std::int64_t{a} * a) +
                                static_cast<std::uint64_t>(std::int64_t{b} * b);
  // m 2^30 or m 2^28 with m / 2^30 in [1, 4); a / r = a y / 2^(31 + 30 or 29).
  PlaneRotation rotation;
  const auto set = [&](int down, std::int32_t y) {
    rotation.cosine = static_cast<std::int32_t>(wide::round_shift_far(std::int64_t{a} * y, down));
    rotation.sine = static_cast<std::int32_t>(wide::round_shift_far(std::int64_t{b} * y, down));
  };
  if (squared >> 60U != 0) {
    set(31, inverse_root(static_cast<std::uint32_t>(squared >> 30U)));
  } else {
    set(30, inverse_root(static_cast<std::uint32_t>(squared >> 28U)));
  }
  return rotation;
}

void rotate(PlaneRotation by, std::int32_t* a, std::int32_t* b, int count) {
  const std::int32_t c = with_31_bits(by.cosine);
  const std::int32_t s = with_31_bits(by.sine);
  const std::int32_t minus_s = with_31_bits(-by.sine);  // sums alone: one multiply-add each
  // The upper half of a sum, to nearest, without a shift across the halves.
  const auto upper = [](std::int64_t sum) {
    return static_cast<std::int32_t>(sum >> 32) +
           static_cast<std::int32_t>(static_cast<std::uint32_t>(sum) >> 31U);
  };
  const auto doubled = [](std::int32_t x) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(x) << 1U);
  };
#pragma GCC unroll 4
  for (int i = 0; i < count; ++i) {
    const std::int32_t x = doubled(a[i]);
    const std::int32_t y = doubled(b[i]);
    a[i] = upper(std::int64_t{c} * x + std::int64_t{s} * y);
    b[i] = upper(std::int64_t{c} * y + std::int64_t{minus_s} * x);
  }
}

void turn_from_nothing(PlaneRotation by, std::int32_t* a, std::int32_t* b, int count) {
  for (int i = 0; i < count; ++i) {
    const std::int32_t y = b[i];
    a[i] = times(by.sine, y);
    b[i] = times(by.cosine, y);
  }
}

}  // namespace cairn
