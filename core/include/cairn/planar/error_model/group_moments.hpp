#pragma once

#include "cairn/numeric/math.hpp"

namespace cairn::detail {

/// First two moments of a point that turns with a Gaussian angle.
template <class T>
struct TurnedPointMoments {
  T mean[2];
  T cov[3];  ///< 00, 10, 11
  T with_heading[2];
};

/// 1 - exp(-x) and sinh(x) - x for x >= 0, right to the last bits where x is small too: there the
/// differences have none left.
template <class T>
T one_minus_exp(T x) {
  if (!(x < T(0.25))) return T(1) - exp(-x);
  constexpr int kTerms = sizeof(T) > sizeof(float) ? 13 : 7;
  T sum = T(1);
  for (int n = kTerms; n > 1; --n) sum = T(1) - x / static_cast<T>(n) * sum;
  return x * sum;
}
template <class T>
T sinh_minus_itself(T x) {
  if (!(x < T(1))) return T(0.5) * (exp(x) - exp(-x)) - x;
  const T x2 = x * x;
  T sum = T(1);
  for (int n = 16; n > 2; n -= 2) sum = T(1) + x2 / static_cast<T>(n * (n + 1)) * sum;
  return x * x2 / T(6) * sum;
}

/// 1 / variance; 0 of one so small that an angle has none.
template <class T>
T per_variance(T variance) {
  return variance > T(1e-30) ? T(1) / variance : T(0);
}

/// A covariance that two variances allow.
template <class T>
T bounded_covariance(T covariance, T variance_a, T variance_b) {
  const bool both = variance_a > T(0) && variance_b > T(0);
  const T most = both ? sqrt(variance_a) * sqrt(variance_b) : T(0);
  return clamp(covariance, -most, most);
}

/// What `xi` keeps beside the part that is correlated with an angle of that variance: 00, 10, 11.
/// Positive semi-definite whatever is rounded.
template <class T>
void part_beside_angle(T variance, const T* c, const T* xi, T* part) {
  const T per = per_variance(variance);
  part[0] = xi[0] - c[0] * c[0] * per;
  part[1] = xi[1] - c[0] * c[1] * per;
  part[2] = xi[2] - c[1] * c[1] * per;
  if (!(part[0] > T(0))) part[0] = T(0);
  if (!(part[2] > T(0))) part[2] = T(0);
  part[1] = bounded_covariance(part[1], part[0], part[2]);
}

/// Exact moments of R(e) m + xi with e ~ N(0, heading_variance), Cov(xi, e), xi = Cov(xi) given as
/// 00, 10, 11. A sum of positive semi-definite parts: what bends, what follows the angle to
/// first order, and what is independent of it. Added up in another order, parts that cancel could
/// leave a negative variance.
template <class T>
TurnedPointMoments<T> turned_point_moments(T heading_variance, const T* m, const T* with_heading,
                                           const T* xi) {
  const T s2 = heading_variance;
  const T c[2] = {bounded_covariance(with_heading[0], s2, xi[0]),
                  bounded_covariance(with_heading[1], s2, xi[2])};
  const T rho = exp(T(-0.5) * s2);
  const T bend = one_minus_exp(s2);
  const T along = T(0.5) * bend * bend;
  const T across = s2 < T(40) ? rho * rho * sinh_minus_itself(s2) : T(0.5);
  const T jm[2] = {-m[1], m[0]};
  const T per = per_variance(s2);
  const T g[2] = {rho * jm[0] + c[0] * per, rho * jm[1] + c[1] * per};
  T beside[3];
  part_beside_angle(s2, c, xi, beside);
  TurnedPointMoments<T> out;
  out.mean[0] = rho * m[0];
  out.mean[1] = rho * m[1];
  out.cov[0] = along * m[0] * m[0] + across * jm[0] * jm[0] + s2 * g[0] * g[0] + beside[0];
  out.cov[1] = along * m[0] * m[1] + across * jm[0] * jm[1] + s2 * g[0] * g[1] + beside[1];
  out.cov[2] = along * m[1] * m[1] + across * jm[1] * jm[1] + s2 * g[1] * g[1] + beside[2];
  out.with_heading[0] = rho * s2 * jm[0] + c[0];
  out.with_heading[1] = rho * s2 * jm[1] + c[1];
  return out;
}

}  // namespace cairn::detail
