#pragma once

#include "cairn/numeric/math.hpp"

namespace cairn::detail {

/// Exponential of the planar group for a turn t: p -> R(t) p + V(t) xi = p + V(t) (xi + t J p), V
/// = [v00 -v01; v01 v00] with v00 = sin t / t and v01 = (1 - cos t) / t = sin^2(t/2) / (t/2).
template <class T>
struct PlanarExponential {
  T angle = T(0);  ///< t, limited to [-pi, pi]
  T v00 = T(1);
  T v01 = T(0);

  explicit PlanarExponential(T turn_rad) : angle(clamp(turn_rad, -kPi<T>, kPi<T>)) {
    if (abs(angle) < T(1e-4)) {
      v00 = T(1) - angle * angle / T(6);
      v01 = T(0.5) * angle;
      return;
    }
    T sine = T(0);
    T cosine = T(1);
    sin_cos(T(0.5) * angle, sine, cosine);
    v00 = T(2) * sine * cosine / angle;
    v01 = T(2) * sine * sine / angle;
  }

  /// Moves `count` points of `Dim` coordinates by their `xi`; a height moves by its own.
  template <int Dim>
  void move(T* __restrict p, const T* __restrict xi, int count) const {
    // V t J = R(t) - 1, as rows of factors: the two coordinates go through the same operations.
    const T a00 = v00;
    const T turn = angle * a00;
    const T same = -angle * v01;
    const T crossed[2] = {-turn, turn};
    const T across[2] = {-v01, v01};
    for (int k = 0; k < count; ++k) {
      const T swapped_p[2] = {p[1], p[0]};
      const T swapped_xi[2] = {xi[1], xi[0]};
      for (int i = 0; i < 2; ++i) {
        p[i] += same * p[i] + crossed[i] * swapped_p[i] + a00 * xi[i] + across[i] * swapped_xi[i];
      }
      if constexpr (Dim > 2) p[2] += xi[2];
      p += Dim;
      xi += Dim;
    }
  }
};

}  // namespace cairn::detail
