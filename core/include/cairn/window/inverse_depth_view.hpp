#pragma once

#include "cairn/geometry/rigid.hpp"
#include "cairn/geometry/types.hpp"

namespace cairn {

/// Transform between the cameras of two keyframes: points of the host's frame to the target's.
template <class T>
struct CameraStep {
  Matrix3<T> rotation = Matrix3<T>::Identity();
  Vector3<T> translation = Vector3<T>::Zero();

  CameraStep() = default;
  CameraStep(const Rigid<T>& T_host_world, const Rigid<T>& T_target_world) {
    rotation = (T_target_world.rotation * T_host_world.rotation.conjugate()).toRotationMatrix();
    translation = T_target_world.translation - rotation * T_host_world.translation;
  }
};

/// A point on the ray (x, y, 1) of its host, at inverse depth rho, as another camera sees it:
/// p = R ray + rho t, which is the point divided by its depth in the host.
template <class T>
struct InverseDepthView {
  /// Nearest depth in the target, relative to that in the host.
  static constexpr T kLeastDepth = T(0.05);

  Vector3<T> p = Vector3<T>::Zero();
  Vector2<T> seen = Vector2<T>::Zero();  ///< p.xy / p.z

  /// False where the point is behind the camera, or nearly so.
  bool project(const CameraStep<T>& step, const Vector2<T>& ray, T rho) {
    const Matrix3<T>& r = step.rotation;
    const Vector3<T>& t = step.translation;
    for (int i = 0; i < 3; ++i) p(i) = r(i, 0) * ray.x() + r(i, 1) * ray.y() + r(i, 2) + rho * t(i);
    if (!(p.z() >= kLeastDepth)) return false;
    const T inverse = T(1) / p.z();
    seen = Vector2<T>(p.x() * inverse, p.y() * inverse);
    return true;
  }
};

/// Derivatives of InverseDepthView::seen, rows x and y: by a perturbation of the target's pose,
/// T_target_world <- (Exp(phi), rho) T_target_world, in the order (phi, rho), and by the inverse
/// depth.
template <class T>
struct InverseDepthJacobian {
  T by_pose[2][6];
  T by_depth[2];

  InverseDepthJacobian(const InverseDepthView<T>& view, const Vector3<T>& translation, T rho) {
    const T inverse = T(1) / view.p.z();
    const T x = view.seen.x();
    const T y = view.seen.y();
    by_pose[0][0] = -x * y;
    by_pose[0][1] = T(1) + x * x;
    by_pose[0][2] = -y;
    by_pose[1][0] = -(T(1) + y * y);
    by_pose[1][1] = x * y;
    by_pose[1][2] = x;
    const T scaled = rho * inverse;
    by_pose[0][3] = scaled;
    by_pose[0][4] = T(0);
    by_pose[0][5] = -x * scaled;
    by_pose[1][3] = T(0);
    by_pose[1][4] = scaled;
    by_pose[1][5] = -y * scaled;
    by_depth[0] = inverse * (translation.x() - x * translation.z());
    by_depth[1] = inverse * (translation.y() - y * translation.z());
  }
};

/// T_camera_world <- (Exp(phi), rho) T_camera_world for a step (phi, rho).
template <class T>
Rigid<T> perturbed(const Rigid<T>& T_camera_world, const T* step) {
  const Quaternion<T> turn = rotation_exp(Vector3<T>(step[0], step[1], step[2]));
  Rigid<T> result;
  result.rotation = turn * T_camera_world.rotation;
  result.rotation.coeffs() *= T(1) / sqrt(result.rotation.squaredNorm());
  result.translation = turn * T_camera_world.translation + Vector3<T>(step[3], step[4], step[5]);
  return result;
}

}  // namespace cairn
