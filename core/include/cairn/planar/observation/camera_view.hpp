#pragma once

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/planar/observation/linearised_observation.hpp"

namespace cairn {

/// Nearest landmark that a camera update uses, m: closer, the rows are not linear enough.
template <class T>
inline constexpr T kNearestLandmark = T(0.3);

/// A camera fixed to the vehicle, as an update needs it. `camera` must outlive it. Where the
/// vehicle tilts, the mounting is that against the level vehicle, at its mean tilt.
template <class T>
struct CameraView {
  const PinholeCamera<T>* camera = nullptr;
  Matrix3<T> R_camera_vehicle = Matrix3<T>::Identity();
  Vector3<T> t_camera_vehicle = Vector3<T>::Zero();
  T sigma_px = T(1);
  T variance_px = T(1);
  RelativeFrame<T> frame;
  bool tilts = false;  ///< with the vehicle

  CameraView(const PinholeCamera<T>& pinhole, const Rigid<T>& T_vehicle_camera, T sigma)
      : camera(&pinhole), sigma_px(sigma), variance_px(sigma * sigma) {
    mount(T_vehicle_camera);
  }

  void mount(const Rigid<T>& T_vehicle_camera) {
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

  /// Rows of a pixel, all coefficients from the predicted pixel: with the measured one the map
  /// shrinks by 2 to 4 %. The noise grows with the relative variance of the depth, sigma^2 (1 + Var
  /// z / z^2): the expectation of the row that is linear in the state, z-scaled. False when the
  /// point is too near or outside the camera's model; `out.innovation` is minus the predicted
  /// pixel.
  bool linearise(const T* relative, const RelativeCovariance<T>& covariance,
                 LinearisedObservation<T, 3>& out, Vector3<T>& p_camera) const {
    p_camera = to_camera(relative);
    if (!(p_camera.z() >= kNearestLandmark<T>)) return false;
    Vector2<T> pixel;
    Matrix<T, 2, 3> by_camera;
    if (!ok(camera->project(p_camera, pixel, by_camera))) return false;
    out.rows = 2;
    out.direct = false;
    out.tilts = tilts;
    for (int r = 0; r < 2; ++r) {
      for (int k = 0; k < 3; ++k) {
        T sum = T(0);
        for (int i = 0; i < 3; ++i) sum += by_camera(r, i) * R_camera_vehicle(i, k);
        out.h[r][k] = sum;
      }
      frame.row_to_relative(out.h[r][0], out.h[r][1]);
    }
    T depth[3] = {R_camera_vehicle(2, 0), R_camera_vehicle(2, 1), R_camera_vehicle(2, 2)};
    frame.row_to_relative(depth[0], depth[1]);
    const T depth_variance = covariance.form(depth, depth);
    const T noise = variance_px * (T(1) + depth_variance / (p_camera.z() * p_camera.z()));
    out.innovation[0] = -pixel.x();
    out.innovation[1] = -pixel.y();
    out.r00 = noise;
    out.r01 = T(0);
    out.r11 = noise;
    return true;
  }
};

}  // namespace cairn
