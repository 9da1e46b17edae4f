#pragma once

#include "cairn/geometry/types.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/planar/tilt.hpp"

namespace cairn {

/// Rotation from a filter's relative frame to the vehicle frame, body = R^T relative. The relative
/// frame has the world's axes in filters that know the heading, the vehicle's in the lifted one.
template <class T>
struct RelativeFrame {
  T cosine = T(1);
  T sine = T(0);

  void to_body(const T* relative, T* body) const {
    body[0] = cosine * relative[0] + sine * relative[1];
    body[1] = cosine * relative[1] - sine * relative[0];
  }
  void to_relative(const T* body, T* relative) const {
    relative[0] = cosine * body[0] - sine * body[1];
    relative[1] = sine * body[0] + cosine * body[1];
  }
  /// Row of a Jacobian by the body vector, turned into one by the relative vector.
  void row_to_relative(T& a, T& b) const {
    const T a0 = a;
    a = a0 * cosine - b * sine;
    b = a0 * sine + b * cosine;
  }
};

/// Covariance of a relative vector, lower triangle row by row: 00, 10, 11, 20, 21, 22.
template <class T>
struct RelativeCovariance {
  T s[6] = {};

  T at(int i, int j) const { return i >= j ? s[i * (i + 1) / 2 + j] : s[j * (j + 1) / 2 + i]; }

  /// a^T Cov b.
  template <int Dim>
  T form(const T (&a)[Dim], const T (&b)[Dim]) const {
    T sum = T(0);
    for (int i = 0; i < Dim; ++i) {
      for (int j = 0; j < Dim; ++j) sum += a[i] * at(i, j) * b[j];
    }
    return sum;
  }
};

/// One or two measurement rows of one landmark: all that an update needs. The rows act on the
/// relative vector (landmark minus vehicle) alone: there is no other dependence, and in particular
/// none on the heading of a filter whose error keeps the gauge. A single row leaves the second one
/// zero, with noise 1.
template <class T, int Dim>
struct LinearisedObservation {
  int slot = -1;
  int source = -1;      ///< index of the observation that it came from
  int rows = 2;         ///< 1 or 2
  bool direct = false;  ///< h is [I 0]: the two rows are the relative x and y
  bool tilts = false;   ///< of a sensor that tilts with the vehicle: TiltRows belong to it
  T innovation[2] = {};
  T h[2][Dim] = {};  ///< by the relative vector
  T r00 = T(0);      ///< measurement noise
  T r01 = T(0);
  T r11 = T(1);

  T row(int r, const T* relative) const {
    if (direct) return relative[r];
    T sum = h[r][0] * relative[0] + h[r][1] * relative[1];
    if constexpr (Dim > 2) sum += h[r][2] * relative[2];
    return sum;
  }
};

/// Rows of an observation by the vehicle's tilt (pitch, roll). They follow from those by the
/// relative vector v: h (v x axis).
template <class T>
struct TiltRows {
  T t[2][2] = {};

  TiltRows() = default;
  TiltRows(const LinearisedObservation<T, 3>& o, const T* v, const TiltAxes<T>& axes) {
    for (int k = 0; k < 2; ++k) {
      const T* a = axes.axis(k);
      const T turned[3] = {v[1] * a[2] - v[2] * a[1], v[2] * a[0] - v[0] * a[2],
                           v[0] * a[1] - v[1] * a[0]};
      for (int r = 0; r < 2; ++r) {
        t[r][k] = o.h[r][0] * turned[0] + o.h[r][1] * turned[1] + o.h[r][2] * turned[2];
      }
    }
  }
  T row(int r, const T* tilt) const { return t[r][0] * tilt[0] + t[r][1] * tilt[1]; }
};

/// Covariance of the tilt: with a relative vector, and its own, 00, 10, 11.
template <class T>
struct TiltCovariance {
  T with_relative[2][3] = {};
  T own[3] = {};
};

/// Innovation covariance S of a linearised observation.
template <class T>
struct InnovationCovariance {
  T s00 = T(0);
  T s01 = T(0);
  T s11 = T(0);

  /// nu^T S^-1 nu; false when S is not positive definite.
  bool mahalanobis(const T (&nu)[2], T& squared) const {
    T a = T(0);
    T b = T(0);
    T c = T(0);
    if (!invert(a, b, c)) return false;
    squared = a * nu[0] * nu[0] + T(2) * b * nu[0] * nu[1] + c * nu[1] * nu[1];
    return true;
  }
  bool invert(T& a, T& b, T& c) const {
    const T determinant = s00 * s11 - s01 * s01;
    if (!(s00 > T(0)) || !(determinant > T(0))) return false;
    const T scale = T(1) / determinant;
    a = s11 * scale;
    b = -s01 * scale;
    c = s00 * scale;
    return true;
  }
};

/// S of `observation` when the relative vector has covariance `relative`.
template <class T, int Dim>
InnovationCovariance<T> innovation_covariance(const LinearisedObservation<T, Dim>& observation,
                                              const RelativeCovariance<T>& relative) {
  const LinearisedObservation<T, Dim>& o = observation;
  if (o.direct) return {relative.s[0] + o.r00, relative.s[1] + o.r01, relative.s[2] + o.r11};
  return {relative.form(o.h[0], o.h[0]) + o.r00, relative.form(o.h[0], o.h[1]) + o.r01,
          relative.form(o.h[1], o.h[1]) + o.r11};
}

/// Adds the tilt's part to S.
template <class T>
void add_tilt_covariance(const LinearisedObservation<T, 3>& o, const TiltRows<T>& rows,
                         const TiltCovariance<T>& tilt, InnovationCovariance<T>& s) {
  // S += h c t^T + t c^T h^T + t P t^T, per pair of rows.
  T half[2][2];  // h c + t P / 2
  const T own[2][2] = {{tilt.own[0], tilt.own[1]}, {tilt.own[1], tilt.own[2]}};
  for (int r = 0; r < 2; ++r) {
    for (int k = 0; k < 2; ++k) {
      half[r][k] = o.row(r, tilt.with_relative[k]) + T(0.5) * rows.row(r, own[k]);
    }
  }
  s.s00 += T(2) * rows.row(0, half[0]);
  s.s01 += rows.row(0, half[1]) + rows.row(1, half[0]);
  s.s11 += T(2) * rows.row(1, half[1]);
}

}  // namespace cairn
