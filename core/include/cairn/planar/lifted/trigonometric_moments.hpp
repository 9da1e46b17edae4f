#pragma once

#include "cairn/numeric/math.hpp"

namespace cairn::detail {

template <class T>
struct Complex {
  T re = T(0);
  T im = T(0);

  friend Complex operator+(Complex a, Complex b) { return {a.re + b.re, a.im + b.im}; }
  friend Complex operator-(Complex a, Complex b) { return {a.re - b.re, a.im - b.im}; }
  friend Complex operator*(Complex a, Complex b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
  }
  friend Complex operator*(T f, Complex a) { return {f * a.re, f * a.im}; }
};

/// exp(x) - 1 without cancellation near 0.
template <class T>
T exp_minus_one(T x) {
  if (abs(x) > T(0.25)) return exp(x) - T(1);
  T sum = T(0);
  T term = T(1);
  for (int k = 1; k <= 12; ++k) {
    term *= x / static_cast<T>(k);
    sum += term;
  }
  return sum;
}

/// Trigonometric polynomial sum_k c_k e^{i k angle}, |k| <= 4, times one variable of a Gaussian:
/// index 0 stands for the constant 1.
template <class T>
struct TrigMonomial {
  static constexpr int kHarmonics = 4;

  Complex<T> c[2 * kHarmonics + 1];
  int variable = 0;

  Complex<T>& at(int k) { return c[k + kHarmonics]; }
  Complex<T> at(int k) const { return c[k + kHarmonics]; }

  static TrigMonomial constant() {
    TrigMonomial m;
    m.at(0) = {T(1), T(0)};
    return m;
  }
  static TrigMonomial cosine(int k) {
    TrigMonomial m;
    m.at(k) = {T(0.5), T(0)};
    m.at(-k) = {T(0.5), T(0)};
    return m;
  }
  static TrigMonomial sine(int k) {
    TrigMonomial m;
    m.at(k) = {T(0), T(-0.5)};
    m.at(-k) = {T(0), T(0.5)};
    return m;
  }
  TrigMonomial of(int index) const {
    TrigMonomial m = *this;
    m.variable = index;
    return m;
  }
  /// Product; at most one factor may hold a variable, and the harmonics must fit.
  friend TrigMonomial operator*(const TrigMonomial& a, const TrigMonomial& b) {
    TrigMonomial m;
    m.variable = a.variable + b.variable;
    for (int k = -kHarmonics; k <= kHarmonics; ++k) {
      for (int l = -kHarmonics; l <= kHarmonics; ++l) {
        if (k + l < -kHarmonics || k + l > kHarmonics) continue;
        m.at(k + l) = m.at(k + l) + a.at(k) * b.at(l);
      }
    }
    return m;
  }
};

/// Exact means and covariances of trigonometric monomials of a Gaussian (angle, v1, v2), by its
/// characteristic function: with mu_f(k) = mean_f + i k Cov(v_f, angle), phi_k = exp(-k^2 s / 2),
///
///   E[v_f e^{ik angle}]            = phi_k mu_f(k) e^{ik mean}
///   Cov[v_f e^{ik.}, v_g e^{il.}]  = phi_k phi_l ((mu_f(k+l) mu_g(k+l) + C_fg)(e^{-kls} - 1)
///                                    + C_fg + i k c_g mu_f(k) + i l c_f mu_g(l) - k l c_f c_g),
///
/// arranged so that nothing of first order cancels: small variances keep their digits.
template <class T>
class TrigonometricMoments {
 public:
  /// Index 0 of `mean` and `covariance` is the angle, 1 and 2 are v1 and v2.
  TrigonometricMoments(const T (&mean)[3], const T (&covariance)[3][3]) {
    constexpr int kH = TrigMonomial<T>::kHarmonics;
    variance_ = covariance[0][0];
    for (int v = 1; v < 3; ++v) {
      mean_[v] = mean[v];
      with_angle_[v] = covariance[v][0];
      for (int w = 1; w < 3; ++w) between_[v][w] = covariance[v][w];
    }
    mean_[0] = T(1);
    for (int k = -kH; k <= kH; ++k) {
      const T order = static_cast<T>(k);
      const T damping = exp(T(-0.5) * order * order * variance_);
      T s = T(0);
      T c = T(1);
      sin_cos(order * mean[0], s, c);
      turn_[k + kH] = {damping * c, damping * s};
    }
  }

  T mean(const TrigMonomial<T>& f) const {
    constexpr int kH = TrigMonomial<T>::kHarmonics;
    T sum = T(0);
    for (int k = -kH; k <= kH; ++k) {
      sum += (f.at(k) * turn_[k + kH] * mu(f.variable, k)).re;
    }
    return sum;
  }

  T covariance(const TrigMonomial<T>& f, const TrigMonomial<T>& g) const {
    constexpr int kH = TrigMonomial<T>::kHarmonics;
    T sum = T(0);
    for (int k = -kH; k <= kH; ++k) {
      if (f.at(k).re == T(0) && f.at(k).im == T(0)) continue;
      for (int l = -kH; l <= kH; ++l) {
        if (g.at(l).re == T(0) && g.at(l).im == T(0)) continue;
        const Complex<T> amplitude = f.at(k) * turn_[k + kH] * (g.at(l) * turn_[l + kH]);
        sum += (amplitude * harmonic_covariance(f.variable, k, g.variable, l)).re;
      }
    }
    return sum;
  }

 private:
  Complex<T> mu(int v, int k) const { return {mean_[v], static_cast<T>(k) * with_angle_[v]}; }

  Complex<T> harmonic_covariance(int f, int k, int g, int l) const {
    const T tk = static_cast<T>(k);
    const T tl = static_cast<T>(l);
    const Complex<T> between = {between_[f][g], T(0)};
    const Complex<T> product = mu(f, k + l) * mu(g, k + l) + between;
    const Complex<T> shift = Complex<T>{T(0), tk * with_angle_[g]} * mu(f, k) +
                             Complex<T>{T(0), tl * with_angle_[f]} * mu(g, l);
    const Complex<T> second = {tk * tl * with_angle_[f] * with_angle_[g], T(0)};
    return exp_minus_one(-tk * tl * variance_) * product + between + shift - second;
  }

  T variance_ = T(0);
  T mean_[3] = {};
  T with_angle_[3] = {};
  T between_[3][3] = {};
  Complex<T> turn_[2 * TrigMonomial<T>::kHarmonics + 1];
};

/// Columns q_r with sum_r q_r q_r^T = C for a positive semi-definite C; columns below `tolerance`
/// times the trace are left out. The number of columns.
template <class T, int N>
int semidefinite_factor(T (&C)[N][N], T tolerance, T (&q)[N][N]) {
  T trace = T(0);
  for (int i = 0; i < N; ++i) trace += C[i][i];
  int rank = 0;
  for (int step = 0; step < N; ++step) {
    int pivot = 0;
    for (int i = 1; i < N; ++i) {
      if (C[i][i] > C[pivot][pivot]) pivot = i;
    }
    if (!(C[pivot][pivot] > tolerance * trace)) break;
    const T scale = T(1) / sqrt(C[pivot][pivot]);
    for (int i = 0; i < N; ++i) q[rank][i] = C[i][pivot] * scale;
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j < N; ++j) C[i][j] -= q[rank][i] * q[rank][j];
    }
    for (int i = 0; i < N; ++i) {
      C[i][pivot] = T(0);
      C[pivot][i] = T(0);
    }
    ++rank;
  }
  return rank;
}

}  // namespace cairn::detail
