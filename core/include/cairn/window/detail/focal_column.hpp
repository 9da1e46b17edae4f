#pragma once

#include "cairn/window/inverse_depth_view.hpp"

namespace cairn::detail {

/// Adjoint of a camera step T: Exp(a) T = T Exp(b) with a = Ad(T) b, in the order (phi, rho).
template <class T>
Matrix<T, 6, 6> adjoint(const CameraStep<T>& step) {
  Matrix<T, 6, 6> result = Matrix<T, 6, 6>::Zero();
  result.template topLeftCorner<3, 3>() = step.rotation;
  result.template bottomRightCorner<3, 3>() = step.rotation;
  result.template bottomLeftCorner<3, 3>() = skew(step.translation) * step.rotation;
  return result;
}

/// The focal length's part of the normal equations, from what one keyframe saw of one host.
template <class T>
struct FocalColumn {
  Vector<T, 6> by_pose = Vector<T, 6>::Zero();
  T information = T(0);
  T gradient = T(0);

  /// `carried`: how the step between the two follows where their poses are fixed.
  FocalColumn(const CameraStep<T>& step, T narrower, const Vector<T, 6>& carried)
      : narrower_(narrower),
        turn_(carried.template head<3>()),
        axis_(narrower * step.rotation.col(2)),
        shift_(narrower * step.translation + carried.template tail<3>()) {}

  /// Adds an observation; returns the element that couples the focal length to the depth. A longer
  /// focal length makes the host's ray narrower and the picture of a direction larger.
  T add(const InverseDepthView<T>& view, const InverseDepthJacobian<T>& j, T rho, T weight,
        const Vector2<T>& residual) {
    const Vector3<T> moved = axis_ + turn_.cross(view.p) + rho * shift_;
    const T inverse = T(1) / view.p.z();
    T by_focal[2];
    for (int i = 0; i < 2; ++i) {
      by_focal[i] = narrower_ * view.seen(i) + inverse * (moved(i) - view.seen(i) * moved.z());
    }
    const T u = weight * by_focal[0];
    const T v = weight * by_focal[1];
    for (int r = 0; r < 6; ++r) by_pose(r) += u * j.by_pose[0][r] + v * j.by_pose[1][r];
    information += u * by_focal[0] + v * by_focal[1];
    gradient += u * residual.x() + v * residual.y();
    return u * j.by_depth[0] + v * j.by_depth[1];
  }

 private:
  T narrower_;
  Vector3<T> turn_;
  Vector3<T> axis_;
  Vector3<T> shift_;
};

}  // namespace cairn::detail
