#pragma once

#include <cmath>
#include <cstdint>

namespace cairn {

/// Elementary functions of the core. libm is not the same on every target (glibc picks by CPU,
/// newlib has single-precision variants), so anything beyond sqrt, fabs and floor is a polynomial
/// evaluated here in a fixed order: same input, same bytes, on host and board. Coefficients: fdlibm
/// (Sun 1993) for double, Cephes (Moshier) for float.

template <class T>
inline constexpr T kPi = static_cast<T>(3.14159265358979323846);
template <class T>
inline constexpr T kTwoPi = static_cast<T>(6.28318530717958647692);
template <class T>
inline constexpr T kHalfPi = static_cast<T>(1.57079632679489661923);

/// Chi-square quantiles used as gates: P(chi2_dof <= value) = level.
inline constexpr double kChi2Dof1Level95 = 3.841458820694124;
inline constexpr double kChi2Dof2Level95 = 5.991464547107979;
inline constexpr double kChi2Dof2Level99 = 9.210340371976182;
inline constexpr double kChi2Dof2Level999 = 13.815510557964274;
inline constexpr double kChi2Dof3Level99 = 11.344866730144373;

template <class T>
constexpr T clamp(T value, T low, T high) {
  return value < low ? low : (value > high ? high : value);
}
template <class T>
constexpr T square(T value) {
  return value * value;
}

inline float sqrt(float x) {
  return std::sqrt(x);
}
inline double sqrt(double x) {
  return std::sqrt(x);
}

/// Largest integer whose square is at most `value`. Cost: at most 32 steps.
std::uint32_t integer_sqrt(std::uint64_t value);

inline float abs(float x) {
  return std::fabs(x);
}
inline double abs(double x) {
  return std::fabs(x);
}
inline float floor(float x) {
  return std::floor(x);
}
inline double floor(double x) {
  return std::floor(x);
}

/// True for anything but NaN and infinities; works on values without naming their bits.
template <class T>
bool is_finite(T x) {
  return x - x == T(0);  // NOLINT(misc-redundant-expression): not for NaN and infinities
}
/// Finite and above 0.
template <class T>
bool is_positive(T x) {
  return is_finite(x) && x > T(0);
}

/// Sine and cosine of `angle` in rad, |angle| <= 1e4 (larger angles lose accuracy, never
/// finiteness; not finite gives 0 and 1). Absolute error below 2e-7 (float), 3e-16 (double) for
/// |angle| <= 10.
void sin_cos(float angle, float& sine, float& cosine);
void sin_cos(double angle, double& sine, double& cosine);

/// Angle of the vector (x, y) in (-pi, pi]; 0 for the zero vector. Absolute error below 3e-7 /
/// 5e-16.
float atan2(float y, float x);
double atan2(double y, double x);

/// exp(x), clamped to the finite range: x < -87 (float) or -708 (double) gives 0, and x above 88 or
/// 709 the value at that bound. Relative error below 2e-7 / 1e-15.
float exp(float x);
double exp(double x);

/// Natural logarithm of x > 0 (x <= 0 gives the value at the smallest normal number). Relative
/// error below 2e-7 / 1e-15 away from x = 1, absolute near it.
float log(float x);
double log(double x);

/// Angle wrapped to (-pi, pi]; |angle| <= 1e4 rad.
template <class T>
T wrap_angle(T angle) {
  if (angle > -kPi<T> && angle <= kPi<T>) return angle;
  const T turns = floor((angle + kPi<T>) / kTwoPi<T>);
  T wrapped = angle - turns * kTwoPi<T>;
  if (wrapped <= -kPi<T>) wrapped += kTwoPi<T>;
  if (wrapped > kPi<T>) wrapped -= kTwoPi<T>;
  return wrapped;
}

/// Nearest integer, halves up. Clamped to +-2^30 and 0 for NaN first, because the conversion of an
/// out-of-range value differs between CPUs.
template <class T>
int round_to_int(T x) {
  const T limit = T(1073741824);
  if (!(x > -limit)) return x <= -limit ? -1073741824 : 0;
  if (x >= limit) return 1073741824;
  return static_cast<int>(floor(x + T(0.5)));
}

}  // namespace cairn
