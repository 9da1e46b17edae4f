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

/// Exact moments of R(e) m + xi with e ~ N(0, heading_variance), c = Cov(xi, e), xi = Cov(xi) given
/// as 00, 10, 11.
template <class T>
TurnedPointMoments<T> turned_point_moments(T heading_variance, const T* m, const T* c,
                                           const T* xi) {
  const T s2 = heading_variance;
  const T rho = exp(T(-0.5) * s2);
  const T rho2 = rho * rho;
  const T rho4 = rho2 * rho2;
  const T vc = T(0.5) * (T(1) + rho4) - rho2;
  const T vs = T(0.5) * (T(1) - rho4);
  const T jm[2] = {-m[1], m[0]};
  TurnedPointMoments<T> out;
  out.mean[0] = rho * m[0];
  out.mean[1] = rho * m[1];
  out.cov[0] = vc * m[0] * m[0] + vs * jm[0] * jm[0] + T(2) * rho * jm[0] * c[0] + xi[0];
  out.cov[1] = vc * m[0] * m[1] + vs * jm[0] * jm[1] + rho * (jm[0] * c[1] + jm[1] * c[0]) + xi[1];
  out.cov[2] = vc * m[1] * m[1] + vs * jm[1] * jm[1] + T(2) * rho * jm[1] * c[1] + xi[2];
  out.with_heading[0] = rho * s2 * jm[0] + c[0];
  out.with_heading[1] = rho * s2 * jm[1] + c[1];
  return out;
}

}  // namespace cairn::detail
