#pragma once

#include "cairn/geometry/camera.hpp"

#include "lens_inverse.hpp"

namespace cairn::detail {

/// The radial part of a lens with k4, k5 or k6: d = r n(r^2) / m(r^2), n = 1 + k1 r^2 + k2 r^4 + k3
/// r^6 and m alike with k4 to k6 (OpenCV's rational model), out to where d first stops rising.
template <class T>
class RationalLens {
 public:
  explicit RationalLens(const PinholeCamera<T>& camera)
      : n_{T(1), camera.k1, camera.k2, camera.k3}, m_{T(1), camera.k4, camera.k5, camera.k6} {}

  T value(T r) const { return r * factor(r * r); }
  T slope(T r) const {
    const T r2 = r * r;
    return factor(r2) + T(2) * r2 * factor_slope(r2);
  }
  T factor(T r2) const { return polynomial(n_, r2) / polynomial(m_, r2); }
  /// d factor / d r^2
  T factor_slope(T r2) const {
    return (polynomial_slope(n_, r2) - factor(r2) * polynomial_slope(m_, r2)) / polynomial(m_, r2);
  }

  /// Whether m and the slope of d are above 0 on all of [0, r], r at most that of the widest ray.
  /// Most points are by far.
  bool is_before_fold(T r) const {
    if (!(r <= PinholeCamera<T>::kWidestFisheyeRay)) return false;
    const T r2 = r * r;
    T m[4];
    T numerator[7] = {};  // of the slope, over m^2
    T most = T(0);
    T power = T(1);
    for (int k = 0; k < 7; ++k) {
      for (int i = k < 4 ? 0 : k - 3; i <= (k < 4 ? k : 3); ++i) {
        numerator[k] += static_cast<T>(1 + 2 * (2 * i - k)) * n_[i] * m_[k - i];
      }
      numerator[k] *= power;
      if (k > 0) most += abs(numerator[k]);
      if (k < 4) {
        m[k] = m_[k] * power;
        if (k > 0) most += abs(m[k]);
      }
      power *= r2;
    }
    if (most < T(1)) return true;
    return is_finite(most) && is_positive_on_unit_interval(m) &&
           is_positive_on_unit_interval(numerator);
  }

 private:
  static T polynomial(const T (&c)[4], T x) { return c[0] + x * (c[1] + x * (c[2] + x * c[3])); }
  static T polynomial_slope(const T (&c)[4], T x) {
    return c[1] + x * (T(2) * c[2] + x * T(3) * c[3]);
  }

  T n_[4];
  T m_[4];
};

}  // namespace cairn::detail
