#pragma once

#include "cairn/geometry/camera.hpp"

#include "lens_inverse.hpp"

namespace cairn::detail {

/// Kannala and Brandt (2006): the distance from the axis is d = theta (1 + k1 theta^2 + k2 theta^4
/// + k3 theta^6 + k4 theta^8), theta the angle of the ray with it.
template <class T>
class FisheyeLens {
 public:
  explicit FisheyeLens(const PinholeCamera<T>& camera)
      : k_{T(1), camera.k1, camera.k2, camera.k3, camera.k4} {}

  T value(T theta) const { return theta * factor(theta * theta); }
  T slope(T theta) const {
    const T s = theta * theta;
    return k_[0] + s * (T(3) * k_[1] + s * (T(5) * k_[2] + s * (T(7) * k_[3] + s * T(9) * k_[4])));
  }

  /// Whether the slope is above 0 on all of [0, theta].
  bool is_before_fold(T theta) const {
    const T s = theta * theta;
    T slope[5];
    T most = T(0);
    T power = T(1);
    for (int i = 0; i < 5; ++i) {
      slope[i] = static_cast<T>(2 * i + 1) * k_[i] * power;
      if (i > 0) most += abs(slope[i]);
      power *= s;
    }
    return most < T(1) || (is_finite(most) && is_positive_on_unit_interval(slope));
  }

  /// Distorts (x, y) at depth 1, with the derivative. False beyond the fold or the widest ray.
  bool distort(T x, T y, Vector2<T>& distorted, Matrix2<T>& derivative) const {
    const T r2 = x * x + y * y;
    if (!(r2 <= PinholeCamera<T>::kWidestFisheyeRay * PinholeCamera<T>::kWidestFisheyeRay)) {
      return false;
    }
    T scale = T(0);   // d / r
    T growth = T(0);  // (d d / d r - d / r) / r^2
    if (r2 < kNearAxis) {
      // theta / r = 1 - r^2 / 3 + r^4 / 5 - ...
      const T ratio = T(1) - r2 * (T(1) / T(3) - r2 * (T(1) / T(5) - r2 * (T(1) / T(7))));
      scale = ratio * factor(r2 * ratio * ratio);
      growth = T(2) * (k_[1] - T(1) / T(3));
    } else {
      const T r = sqrt(r2);
      const T theta = atan2(r, T(1));
      if (!is_before_fold(theta)) return false;
      scale = value(theta) / r;
      growth = (slope(theta) / (T(1) + r2) - scale) / r2;
    }
    distorted = Vector2<T>(x * scale, y * scale);
    derivative(0, 0) = scale + growth * x * x;
    derivative(0, 1) = derivative(1, 0) = growth * x * y;
    derivative(1, 1) = scale + growth * y * y;
    return true;
  }

  /// Distance from the axis at depth 1 of the ray seen at `distorted` > 0 from it; false where
  /// there is none, with the outermost one that was tried.
  bool undistort(T distorted, T& r) const {
    T theta = T(0);
    const T widest = atan2(PinholeCamera<T>::kWidestFisheyeRay, T(1));
    const bool found = invert(*this, distorted, widest, theta);
    T sine = T(0);
    T cosine = T(1);
    sin_cos(theta, sine, cosine);
    r = sine / cosine;
    return found;
  }

 private:
  static constexpr T kNearAxis = T(1e-4);

  T factor(T s) const { return k_[0] + s * (k_[1] + s * (k_[2] + s * (k_[3] + s * k_[4]))); }

  T k_[5];
};

}  // namespace cairn::detail
