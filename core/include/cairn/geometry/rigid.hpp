#pragma once

#include "cairn/geometry/types.hpp"
#include "cairn/numeric/math.hpp"

namespace cairn {

/// Rigid transform. Named T_a_b it maps points of frame b to frame a: p_a = T_a_b * p_b.
template <class T>
struct Rigid {
  Quaternion<T> rotation = Quaternion<T>(T(1), T(0), T(0), T(0));
  Vector3<T> translation = Vector3<T>::Zero();

  Vector3<T> operator*(const Vector3<T>& p) const { return rotation * p + translation; }
  Rigid operator*(const Rigid& other) const {
    return {rotation * other.rotation, rotation * other.translation + translation};
  }
  Rigid inverse() const {
    const Quaternion<T> conjugate = rotation.conjugate();
    return {conjugate, -(conjugate * translation)};
  }
};

/// [v]x, so that skew(v) * w = v x w.
template <class T>
Matrix3<T> skew(const Vector3<T>& v) {
  Matrix3<T> m;
  m << T(0), -v.z(), v.y(), v.z(), T(0), -v.x(), -v.y(), v.x(), T(0);
  return m;
}

/// Quaternion of the rotation vector `phi` (rad): exp of so(3). Domain: |phi| <= 1e4.
template <class T>
Quaternion<T> rotation_exp(const Vector3<T>& phi) {
  const T angle_squared = phi.dot(phi);
  const T angle = sqrt(angle_squared);
  T sine = T(0);
  T cosine = T(1);
  sin_cos(T(0.5) * angle, sine, cosine);
  const T factor = angle > T(1e-6) ? sine / angle : T(0.5) - angle_squared / T(48);
  return {cosine, factor * phi.x(), factor * phi.y(), factor * phi.z()};
}

/// Rotation vector of the unit quaternion `q`, |result| <= pi: log of SO(3).
template <class T>
Vector3<T> rotation_log(const Quaternion<T>& q) {
  const T sign = q.w() < T(0) ? T(-1) : T(1);
  const Vector3<T> v = sign * q.vec();
  const T sine = sqrt(v.dot(v));
  if (sine < T(1e-7)) return T(2) * v;
  return (T(2) * atan2(sine, sign * q.w()) / sine) * v;
}

}  // namespace cairn
