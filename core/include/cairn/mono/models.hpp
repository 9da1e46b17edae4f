#pragma once

#include "cairn/base/status.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/types.hpp"

/// The functions of the monocular filter and their Jacobians, free of any state layout, so that
/// each can be tested against automatic differentiation (tests/mono/mono_jacobian_test.cpp).
/// Quaternions are plain vectors (w, x, y, z), camera to world; rotations use the homogeneous form,
/// whose derivative is polynomial.
namespace cairn::mono {

/// Rotation matrix of `q`, homogeneous form: for |q| != 1 it is scaled by |q|^2.
template <class T>
Matrix3<T> rotation_matrix(const Vector<T, 4>& q);

/// d (R(q) v) / d q, 3x4.
template <class T>
Matrix<T, 3, 4> rotated_wrt_quaternion(const Vector<T, 4>& q, const Vector3<T>& v);

/// d (R(q)^T v) / d q, 3x4.
template <class T>
Matrix<T, 3, 4> unrotated_wrt_quaternion(const Vector<T, 4>& q, const Vector3<T>& v);

/// q after the step q * exp(rate dt), with its derivatives.
template <class T>
struct RotationStep {
  Vector<T, 4> q;
  Matrix<T, 4, 4> wrt_q;
  Matrix<T, 4, 3> wrt_rate;
};
template <class T>
RotationStep<T> rotation_step(const Vector<T, 4>& q, const Vector3<T>& rate_radps, T dt_s);

/// d (q / |q|) / d q.
template <class T>
Matrix<T, 4, 4> normalisation_jacobian(const Vector<T, 4>& q);

/// Unit vector of azimuth theta and elevation phi (rad): (cos phi sin theta, -sin phi, cos phi cos
/// theta). Civera et al. 2008, eq. 6. The frame is the camera of the feature's first view, so that
/// the poles (phi = +-pi/2) lie outside any field of view; the published form, in the world frame,
/// is singular for a camera that looks straight down.
template <class T>
struct Direction {
  Vector3<T> m;
  Matrix<T, 3, 2> wrt_angles;
};
template <class T>
Direction<T> direction(T theta, T phi);

/// Angles of the vector `v` (any length) and their derivative. Inverse of direction().
template <class T>
struct Angles {
  T theta;
  T phi;
  Matrix<T, 2, 3> wrt_v;
};
template <class T>
Angles<T> angles_of(const Vector3<T>& v);

/// Pixel of the world vector `ray` (any positive length) seen by a camera of attitude `q`, with
/// derivatives. `wrt_focal` is for a common factor on both focal lengths, 1 + s, already applied in
/// `camera`: it is d pixel / d s. kOutOfView as PinholeCamera::project.
template <class T>
struct RayPixel {
  Vector2<T> pixel;
  Vector3<T> ray_camera;  ///< R^T ray
  Matrix<T, 2, 3> wrt_ray;
  Matrix<T, 2, 4> wrt_q;
  Vector2<T> wrt_focal;
};
template <class T>
Status project_ray(const PinholeCamera<T>& camera, T focal_factor, const Vector<T, 4>& q,
                   const Vector3<T>& ray, RayPixel<T>& out);

/// Ray (x, y, 1) of a pixel, camera frame, with its derivatives by the pixel and by the focal
/// factor s of project_ray(). kDegenerate where the distortion cannot be inverted.
template <class T>
struct PixelRay {
  Vector3<T> ray_camera;
  Matrix<T, 3, 2> wrt_pixel;
  Vector3<T> wrt_focal;
};
template <class T>
Status pixel_ray(const PinholeCamera<T>& camera, T focal_factor, const Vector2<T>& pixel,
                 PixelRay<T>& out);

}  // namespace cairn::mono
