#pragma once

#include <cmath>

namespace cairn::test {

/// Dual number with N derivatives: forward-mode automatic differentiation for checking Jacobians.
template <int N>
struct Dual {
  double v = 0.0;
  double d[N] = {};

  Dual() = default;
  Dual(double value) : v(value) {}  // NOLINT: constants mix with duals
  static Dual variable(double value, int index) {
    Dual out(value);
    out.d[index] = 1.0;
    return out;
  }
};

inline double value_of(double a) {
  return a;
}
template <int N>
double value_of(const Dual<N>& a) {
  return a.v;
}

template <int N>
Dual<N> chain(const Dual<N>& a, double value, double slope) {
  Dual<N> out(value);
  for (int i = 0; i < N; ++i) out.d[i] = slope * a.d[i];
  return out;
}
template <int N>
Dual<N> operator+(const Dual<N>& a, const Dual<N>& b) {
  Dual<N> out(a.v + b.v);
  for (int i = 0; i < N; ++i) out.d[i] = a.d[i] + b.d[i];
  return out;
}
template <int N>
Dual<N> operator-(const Dual<N>& a) {
  return chain(a, -a.v, -1.0);
}
template <int N>
Dual<N> operator-(const Dual<N>& a, const Dual<N>& b) {
  return a + (-b);
}
template <int N>
Dual<N> operator*(const Dual<N>& a, const Dual<N>& b) {
  Dual<N> out(a.v * b.v);
  for (int i = 0; i < N; ++i) out.d[i] = a.d[i] * b.v + a.v * b.d[i];
  return out;
}
template <int N>
Dual<N> operator/(const Dual<N>& a, const Dual<N>& b) {
  Dual<N> out(a.v / b.v);
  for (int i = 0; i < N; ++i) out.d[i] = (a.d[i] * b.v - a.v * b.d[i]) / (b.v * b.v);
  return out;
}
template <int N>
Dual<N> operator*(double a, const Dual<N>& b) {
  return Dual<N>(a) * b;
}
template <int N>
Dual<N> operator+(double a, const Dual<N>& b) {
  return Dual<N>(a) + b;
}
template <int N>
Dual<N> operator-(double a, const Dual<N>& b) {
  return Dual<N>(a) - b;
}
template <int N>
Dual<N> sqrt(const Dual<N>& a) {
  const double root = std::sqrt(a.v);
  return chain(a, root, 0.5 / root);
}
template <int N>
Dual<N> sin(const Dual<N>& a) {
  return chain(a, std::sin(a.v), std::cos(a.v));
}
template <int N>
Dual<N> cos(const Dual<N>& a) {
  return chain(a, std::cos(a.v), -std::sin(a.v));
}
template <int N>
Dual<N> atan2(const Dual<N>& y, const Dual<N>& x) {
  const double r2 = x.v * x.v + y.v * y.v;
  Dual<N> out(std::atan2(y.v, x.v));
  for (int i = 0; i < N; ++i) out.d[i] = (y.d[i] * x.v - x.d[i] * y.v) / r2;
  return out;
}

}  // namespace cairn::test
