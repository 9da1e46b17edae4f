#pragma once

#include "cairn/numeric/fixed.hpp"

namespace cairn {

/// Elementary functions without floating point. Errors are measured over the whole domain
/// (tests/numeric/fixed_math_test.cpp).

using FixedAngle = Fixed<std::int32_t, 28>;  ///< rad, +-8
using FixedRatio = Fixed<std::int32_t, 30>;  ///< +-2: cosines, factors

inline constexpr FixedAngle kFixedPi = FixedAngle::nearest(3.14159265358979323846);

/// Sine and cosine of any angle. Error below 2e-9.
void sin_cos(FixedAngle angle, FixedRatio& sine, FixedRatio& cosine);

/// Angle of the vector (x, y) in any unit, (-pi, pi]; 0 for the zero vector. Error below 1.5e-8.
FixedAngle fixed_atan2(std::int64_t y, std::int64_t x);

/// Angle wrapped to (-pi, pi].
FixedAngle wrapped_angle(std::int64_t angle_raw);

/// exp(-x) with 44 fraction bits of x >= 0 with as many (x < 0: 1). Error below 1e-12.
std::int64_t exp_negative_44(std::int64_t x);

/// Root of value / 2^bits as mantissa / 2^result bits, the mantissa below 2^31 and, but for 0, at
/// least 2^29. Error below half a unit of the mantissa. Negative values have the root 0.
struct FixedRoot {
  std::int32_t mantissa = 0;
  int bits = 0;
};
FixedRoot square_root(std::int64_t value, int bits);

/// Plane rotation [c s; -s c] with 30 fraction bits.
struct PlaneRotation {
  std::int32_t cosine = 1 << 30;
  std::int32_t sine = 0;
};

/// The rotation that turns (a, b) into (r, 0), r >= 0; no turn for the zero vector. Error of both
/// factors below 2.5e-9. Domain: |a|, |b| <= 2^30.
PlaneRotation rotation_onto(std::int32_t a, std::int32_t b);

/// (a_i, b_i) <- (c a_i + s b_i, c b_i - s a_i), factors beyond 1 counted as 1. Domain: the lengths
/// of (a_i, b_i) below 2^30.
void rotate(PlaneRotation by, std::int32_t* a, std::int32_t* b, int count);
/// The same where all a_i count as 0, whatever stands there.
void turn_from_nothing(PlaneRotation by, std::int32_t* a, std::int32_t* b, int count);

}  // namespace cairn
