#pragma once

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/planar/types.hpp"

namespace cairn::detail {

/// Rotation from a filter's relative frame to the vehicle frame, body = R^T relative. The relative
/// frame is the world's axes for filters that know the heading, the vehicle's for the lifted one.
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

/// Two measurement rows of one landmark: all that the update needs. Rows act on the relative vector
/// (landmark minus vehicle) alone: there is no other dependence, and in particular none on the
/// heading of a filter whose error keeps the gauge.
template <class T, int Dim>
struct MeasurementPair {
  int slot = -1;
  int source = -1;      ///< index of the observation it came from
  bool direct = false;  ///< h is [I 0]: the two rows are the relative x and y
  T innovation[2] = {};
  T h[2][Dim] = {};
  T r00 = T(0);  ///< measurement noise
  T r01 = T(0);
  T r11 = T(0);

  T row(int r, const T* relative) const {
    if (direct) return relative[r];
    T sum = h[r][0] * relative[0] + h[r][1] * relative[1];
    if constexpr (Dim > 2) sum += h[r][2] * relative[2];
    return sum;
  }
};

/// Covariance of a relative vector, lower triangle row by row: 00, 10, 11, 20, 21, 22.
template <class T>
struct RelativeCovariance {
  T s[6] = {};

  T at(int i, int j) const { return i >= j ? s[i * (i + 1) / 2 + j] : s[j * (j + 1) / 2 + i]; }

  template <int Dim>
  T form(const T (&a)[Dim], const T (&b)[Dim]) const {
    T sum = T(0);
    for (int i = 0; i < Dim; ++i) {
      for (int j = 0; j < Dim; ++j) sum += a[i] * at(i, j) * b[j];
    }
    return sum;
  }
};

/// Innovation covariance S of a pair.
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

template <class T, int Dim>
InnovationCovariance<T> innovation_covariance(const MeasurementPair<T, Dim>& pair,
                                              const RelativeCovariance<T>& relative) {
  if (pair.direct) {
    return {relative.s[0] + pair.r00, relative.s[1] + pair.r01, relative.s[2] + pair.r11};
  }
  return {relative.form(pair.h[0], pair.h[0]) + pair.r00,
          relative.form(pair.h[0], pair.h[1]) + pair.r01,
          relative.form(pair.h[1], pair.h[1]) + pair.r11};
}

/// Rows of a Cartesian point: rotated into the relative frame, where they are the relative vector
/// itself.
template <class T, int Dim>
void linearise(const PointObservation<T>& observation, const RelativeFrame<T>& frame,
               const T* relative, MeasurementPair<T, Dim>& pair) {
  const T y[2] = {observation.y.x(), observation.y.y()};
  T turned[2];
  frame.to_relative(y, turned);
  pair.direct = true;
  pair.innovation[0] = turned[0] - relative[0];
  pair.innovation[1] = turned[1] - relative[1];
  const T c = frame.cosine;
  const T s = frame.sine;
  const T a = observation.R(0, 0);
  const T b = observation.R(0, 1);
  const T d = observation.R(1, 1);
  pair.r00 = c * c * a - T(2) * c * s * b + s * s * d;
  pair.r01 = c * s * (a - d) + (c * c - s * s) * b;
  pair.r11 = s * s * a + T(2) * c * s * b + c * c * d;
}

/// Rows of range and bearing from a sensor `offset_m` ahead of the vehicle's centre. False when the
/// predicted range is below 5 cm: no bearing there.
template <class T, int Dim>
bool linearise(const RangeBearingObservation<T>& observation, T offset_m,
               const RelativeFrame<T>& frame, const T* relative, MeasurementPair<T, Dim>& pair) {
  T body[2];
  frame.to_body(relative, body);
  body[0] -= offset_m;
  const T squared = body[0] * body[0] + body[1] * body[1];
  if (!(squared > T(0.0025))) return false;
  const T range = sqrt(squared);
  pair.direct = false;
  pair.innovation[0] = observation.range - range;
  pair.innovation[1] = wrap_angle(observation.bearing - atan2(body[1], body[0]));
  const T inverse = T(1) / range;
  const T x = body[0] * inverse;
  const T y = body[1] * inverse;
  pair.h[0][0] = x;
  pair.h[0][1] = y;
  pair.h[1][0] = -y * inverse;
  pair.h[1][1] = x * inverse;
  frame.row_to_relative(pair.h[0][0], pair.h[0][1]);
  frame.row_to_relative(pair.h[1][0], pair.h[1][1]);
  if constexpr (Dim > 2) {
    pair.h[0][2] = T(0);
    pair.h[1][2] = T(0);
  }
  pair.r00 = square(observation.sigma_range);
  pair.r01 = T(0);
  pair.r11 = square(observation.sigma_bearing);
  return true;
}

/// A camera fixed to the vehicle, as the update needs it.
template <class T>
struct CameraView {
  const PinholeCamera<T>* camera = nullptr;
  Matrix3<T> R_camera_vehicle = Matrix3<T>::Identity();
  Vector3<T> t_camera_vehicle = Vector3<T>::Zero();
  T variance_px = T(1);
  RelativeFrame<T> frame;

  CameraView(const PinholeCamera<T>& pinhole, const Rigid<T>& T_vehicle_camera, T sigma_px)
      : camera(&pinhole), variance_px(sigma_px * sigma_px) {
    const Rigid<T> inverse = T_vehicle_camera.inverse();
    R_camera_vehicle = inverse.rotation.toRotationMatrix();
    t_camera_vehicle = inverse.translation;
  }

  Vector3<T> to_camera(const T* relative) const {
    T body[3];
    frame.to_body(relative, body);
    body[2] = relative[2];
    Vector3<T> p = t_camera_vehicle;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) p(i) += R_camera_vehicle(i, j) * body[j];
    }
    return p;
  }
};

/// Nearest landmark that a camera update uses: closer, the rows are not linear enough, m.
template <class T>
inline constexpr T kNearestLandmark = T(0.3);

/// Rows of a pixel, all coefficients from the predicted pixel: with the measured one the map
/// shrinks by 2 to 4 %. The noise grows with the relative variance of the depth, sigma^2 (1 + Var z
/// / z^2): the expectation of the row that is linear in the state, z-scaled. False when the point
/// is too near or outside the camera's model; `pair.innovation` is minus the predicted pixel.
template <class T>
bool linearise(const CameraView<T>& view, const T* relative,
               const RelativeCovariance<T>& covariance, MeasurementPair<T, 3>& pair,
               Vector3<T>& p_camera) {
  p_camera = view.to_camera(relative);
  if (!(p_camera.z() >= kNearestLandmark<T>)) return false;
  Vector2<T> pixel;
  Matrix<T, 2, 3> by_camera;
  if (!ok(view.camera->project(p_camera, pixel, by_camera))) return false;
  pair.direct = false;
  for (int r = 0; r < 2; ++r) {
    for (int k = 0; k < 3; ++k) {
      T sum = T(0);
      for (int i = 0; i < 3; ++i) sum += by_camera(r, i) * view.R_camera_vehicle(i, k);
      pair.h[r][k] = sum;
    }
    view.frame.row_to_relative(pair.h[r][0], pair.h[r][1]);
  }
  T depth[3] = {view.R_camera_vehicle(2, 0), view.R_camera_vehicle(2, 1),
                view.R_camera_vehicle(2, 2)};
  view.frame.row_to_relative(depth[0], depth[1]);
  const T depth_variance = covariance.form(depth, depth);
  const T noise = view.variance_px * (T(1) + depth_variance / (p_camera.z() * p_camera.z()));
  pair.innovation[0] = -pixel.x();
  pair.innovation[1] = -pixel.y();
  pair.r00 = noise;
  pair.r01 = T(0);
  pair.r11 = noise;
  return true;
}

}  // namespace cairn::detail
