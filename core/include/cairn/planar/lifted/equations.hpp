#pragma once

#include "cairn/planar/increment.hpp"

namespace cairn {

/// Misprints of paper A that can be put back. Errata: docs/explanation/errata-paper-a.md.
enum Misprint : unsigned {
  kMisprint18Row6 = 1U,  ///< (18) row 6: + z_i5 u2 instead of - z_i5 u2
  kMisprint26Row5 = 2U,  ///< (26) row 5: - y_new z11 instead of + y_new z11
};

namespace detail {

/// Paper A's lifted model, every equation as a function of its own, so that the tests can hold each
/// against the true motion. With s = sin(heading), c = cos(heading):
///
///   vehicle  (13)  z  = [x, y, s, c, s^2, c^2, x s, x c, y s, y c, s c]
///   landmark (15)  zi = [xi, yi, s xi, c xi, s yi, c yi]
///
/// The paper counts from 1, the code from 0.
inline constexpr int kLiftedVehicle = 11;
inline constexpr int kLiftedLandmark = 6;

/// Monomials of one odometry increment: displacement (ux, uy) in the old vehicle frame (uy = 0 and
/// ux = u1 of the paper for the Euler model), s = sin(turn) = u2, c = cos(turn) = u3. Every
/// transition below is linear in them.
enum Monomial { kOne, kUx, kUy, kS, kC, kUxS, kUxC, kUyS, kUyC, kSS, kCC, kSC, kMonomials };

template <class T>
struct Monomials {
  T m[kMonomials] = {};
};

template <class T>
Monomials<T> monomials(const Displacement<T>& u, T s, T c) {
  const T x = u.u.x();
  const T y = u.u.y();
  return {{T(1), x, y, s, c, x * s, x * c, y * s, y * c, s * s, c * c, s * c}};
}

/// Derivative of monomials() by the distance (J of (11) and (19), its u1 column).
template <class T>
Monomials<T> monomials_by_distance(const Displacement<T>& u, T s, T c) {
  const T x = u.by_distance.x();
  const T y = u.by_distance.y();
  return {{T(0), x, y, T(0), T(0), x * s, x * c, y * s, y * c, T(0), T(0), T(0)}};
}

/// Derivative of monomials() by the turn (the u2 and u3 columns, joined by the chain rule).
template <class T>
Monomials<T> monomials_by_turn(const Displacement<T>& u, T s, T c) {
  const T x = u.u.x();
  const T y = u.u.y();
  const T dx = u.by_turn.x();
  const T dy = u.by_turn.y();
  return {{T(0), dx, dy, c, -s, dx * s + x * c, dx * c - x * s, dy * s + y * c, dy * c - y * s,
           T(2) * s * c, T(-2) * s * c, c * c - s * s}};
}

/// (13), without its first-order noise.
template <class T>
void lift_vehicle(T x, T y, T s, T c, T (&z)[kLiftedVehicle]) {
  const T lifted[kLiftedVehicle] = {x, y, s, c, s * s, c * c, x * s, x * c, y * s, y * c, s * c};
  for (int i = 0; i < kLiftedVehicle; ++i) z[i] = lifted[i];
}

/// (15).
template <class T>
void lift_landmark(T x, T y, T s, T c, T (&z)[kLiftedLandmark]) {
  const T lifted[kLiftedLandmark] = {x, y, s * x, c * x, s * y, c * y};
  for (int i = 0; i < kLiftedLandmark; ++i) z[i] = lifted[i];
}

/// (16): out = A(u) z.
template <class T>
void vehicle_transition(const Monomials<T>& u, const T* z, T* out) {
  const T* m = u.m;
  const T z0 = z[0];
  const T z1 = z[1];
  const T s = z[2];
  const T c = z[3];
  const T ss = z[4];
  const T cc = z[5];
  const T xs = z[6];
  const T xc = z[7];
  const T ys = z[8];
  const T yc = z[9];
  const T sc = z[10];
  out[0] = m[kOne] * z0 + m[kUx] * c - m[kUy] * s;
  out[1] = m[kOne] * z1 + m[kUx] * s + m[kUy] * c;
  out[2] = m[kC] * s + m[kS] * c;
  out[3] = m[kC] * c - m[kS] * s;
  out[4] = m[kCC] * ss + T(2) * m[kSC] * sc + m[kSS] * cc;
  out[5] = m[kCC] * cc - T(2) * m[kSC] * sc + m[kSS] * ss;
  out[6] = m[kC] * xs + m[kS] * xc + m[kUxS] * cc + m[kUxC] * sc - m[kUyC] * ss - m[kUyS] * sc;
  out[7] = m[kC] * xc - m[kS] * xs + m[kUxC] * cc - m[kUxS] * sc - m[kUyC] * sc + m[kUyS] * ss;
  out[8] = m[kC] * ys + m[kS] * yc + m[kUxC] * ss + m[kUxS] * sc + m[kUyC] * sc + m[kUyS] * cc;
  out[9] = m[kC] * yc - m[kS] * ys + m[kUxC] * sc - m[kUxS] * ss + m[kUyC] * cc - m[kUyS] * sc;
  out[10] = (m[kCC] - m[kSS]) * sc + m[kSC] * (cc - ss);
}

/// (18): out = A_i(u) zi. Errata: row 6 is printed with + z_i5 u2
/// (LiftedEquations.LandmarkTransitionIsTheLiftedMotion).
template <class T>
void landmark_transition(const Monomials<T>& u, const T* z, T* out, unsigned misprints) {
  const T* m = u.m;
  const T xs = z[2];
  const T xc = z[3];
  const T ys = z[4];
  const T yc = z[5];
  out[0] = m[kOne] * z[0];
  out[1] = m[kOne] * z[1];
  out[2] = m[kC] * xs + m[kS] * xc;
  out[3] = m[kC] * xc - m[kS] * xs;
  out[4] = m[kC] * ys + m[kS] * yc;
  const T sign = (misprints & kMisprint18Row6) != 0U ? T(1) : T(-1);
  out[5] = m[kC] * yc + sign * m[kS] * ys;
}

/// (21), (22): the landmark in the vehicle frame, linear in the lifted state. Errata: (22) is
/// printed as one sum; it is a 2x1 vector (LiftedEquations.MeasurementIsTheRelativePosition).
template <class T>
void lifted_relative(const T* z, const T* zi, T* out) {
  out[0] = zi[3] + zi[4] - z[7] - z[8];
  out[1] = -zi[2] + zi[5] + z[6] - z[9];
}

/// Parts of (26) that multiply x_new and y_new: the columns of G_new, d zi / d (x_new, y_new), when
/// `z` is the state. Errata: (28) prints d / d x_new alone; row 5 of (26) is printed with - y_new
/// z11 (LiftedEquations.NewLandmarkIsTheLiftedPoint).
template <class T>
void new_landmark_by_observation(const T* z, T* by_x, T* by_y, unsigned misprints) {
  const T x[kLiftedLandmark] = {z[3], z[2], z[10], z[5], z[4], z[10]};
  const T row5 = (misprints & kMisprint26Row5) != 0U ? -z[10] : z[10];
  const T y[kLiftedLandmark] = {-z[2], z[3], -z[4], -z[10], row5, z[5]};
  for (int i = 0; i < kLiftedLandmark; ++i) {
    by_x[i] = x[i];
    by_y[i] = y[i];
  }
}

/// (25), (26): the lifted landmark seen at (x, y) in the vehicle frame; linear in z.
template <class T>
void new_landmark(const T* z, T x, T y, T* out, unsigned misprints) {
  T by_x[kLiftedLandmark];
  T by_y[kLiftedLandmark];
  new_landmark_by_observation(z, by_x, by_y, misprints);
  const T at_vehicle[kLiftedLandmark] = {z[0], z[1], z[6], z[7], z[8], z[9]};
  for (int i = 0; i < kLiftedLandmark; ++i) out[i] = x * by_x[i] + y * by_y[i] + at_vehicle[i];
}

}  // namespace detail
}  // namespace cairn
