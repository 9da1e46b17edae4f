#pragma once

#include "cairn/geometry/camera.hpp"
#include "cairn/mono/detail/sparse_rows.hpp"
#include "cairn/mono/models.hpp"
#include "cairn/mono/parameters.hpp"

namespace cairn::mono {

/// Offsets of the camera block's parts in the state; -1 for a part that the motion model lacks.
struct CameraLayout {
  int position = -1;
  int lever = -1;
  int quaternion = 0;
  int focal = -1;
  int velocity = -1;
  int rate = 0;
  int measured = 0;  ///< pixels depend on the columns [0, measured) of the camera block
  int size = 0;
  int block = 3;  ///< size of a feature or anchor block
};

template <class T>
Vector3<T> vector3_at(const T* x, int at) {
  return {x[at], x[at + 1], x[at + 2]};
}

/// The camera's part of the monocular filter's state: what a state vector `x`, which begins with
/// it, says of the camera, and the columns that a function of it has in a Jacobian.
template <class T>
class CameraBlock {
 public:
  static constexpr int kMaxStates = 14;

  void reset(const PinholeCamera<T>& camera, const MonoParameters<T>& parameters);

  const CameraLayout& layout() const { return layout_; }
  /// As reset() was told.
  const PinholeCamera<T>& told() const { return told_; }

  /// Camera to world.
  Vector<T, 4> quaternion(const T* x) const {
    const T* q = x + layout_.quaternion;
    return {q[0], q[1], q[2], q[3]};
  }
  /// In the world, m.
  Vector3<T> position(const T* x) const;
  T focal_factor(const T* x) const { return layout_.focal < 0 ? T(1) : T(1) + x[layout_.focal]; }
  /// With the focal length of the state.
  PinholeCamera<T> camera(const T* x) const;

  /// Columns of the camera block for a function of position, attitude and focal length.
  void add_camera_run(const T* x, SparseRows<T, 2>& rows, const Matrix<T, 2, 3>& wrt_position,
                      const Matrix<T, 2, 4>& wrt_q, const Vector2<T>& wrt_focal) const;
  /// Columns of the camera block for a function of the position alone.
  template <int Rows>
  void add_position_run(const T* x, SparseRows<T, Rows>& rows,
                        const Matrix<T, Rows, 3>& wrt_position) const;

  /// Largest variances that fading may reach, of the block's states. Without them the directions
  /// that no image can observe (scale, absolute position and heading) would grow as S^k without
  /// bound; the focal length does not move at all.
  void fading_limits(const MonoParameters<T>& parameters, T* limit) const;

 private:
  CameraLayout layout_;
  PinholeCamera<T> told_;
};

/// Largest variances that fading may reach.
template <class T>
struct FadingLimits {
  explicit FadingLimits(const MonoParameters<T>& parameters)
      : length(T(100) / square(parameters.initial_inverse_depth)) {}

  T length;  ///< squared: ten typical depths
  T angle = T(0.25);
};

template <class T>
void CameraBlock<T>::reset(const PinholeCamera<T>& camera, const MonoParameters<T>& parameters) {
  CameraLayout layout;
  int next = 0;
  if (parameters.motion == MotionModel::kSixDof) {
    layout.position = next;
    next += 3;
  }
  if (parameters.motion == MotionModel::kPivot) {
    layout.lever = next;
    next += 3;
  }
  layout.quaternion = next;
  next += 4;
  if (parameters.estimate_focal_length) layout.focal = next++;
  layout.measured = next;
  if (parameters.motion == MotionModel::kSixDof) {
    layout.velocity = next;
    next += 3;
  }
  layout.rate = next;
  layout.size = next + 3;
  layout.block = parameters.motion == MotionModel::kRotationOnly ? 2 : 3;
  layout_ = layout;
  told_ = camera;
}

template <class T>
Vector3<T> CameraBlock<T>::position(const T* x) const {
  if (layout_.position >= 0) return vector3_at(x, layout_.position);
  if (layout_.lever < 0) return Vector3<T>::Zero();
  const Vector3<T> lever = vector3_at(x, layout_.lever);
  return rotation_matrix<T>(quaternion(x)) * lever - lever;
}

template <class T>
PinholeCamera<T> CameraBlock<T>::camera(const T* x) const {
  PinholeCamera<T> camera = told_;
  const T factor = focal_factor(x);
  camera.fx *= factor;
  camera.fy *= factor;
  return camera;
}

template <class T>
void CameraBlock<T>::add_camera_run(const T* x, SparseRows<T, 2>& rows,
                                    const Matrix<T, 2, 3>& wrt_position,
                                    const Matrix<T, 2, 4>& wrt_q,
                                    const Vector2<T>& wrt_focal) const {
  Matrix<T, 2, 8> block = Matrix<T, 2, 8>::Zero();
  const int q = layout_.quaternion;
  block.template block<2, 4>(0, q) = wrt_q;
  if (layout_.position >= 0) block.template block<2, 3>(0, layout_.position) = wrt_position;
  if (layout_.lever >= 0) {
    const Vector<T, 4> attitude = quaternion(x);
    const Matrix3<T> turn = rotation_matrix<T>(attitude) - Matrix3<T>::Identity();
    block.template block<2, 3>(0, layout_.lever) = wrt_position * turn;
    block.template block<2, 4>(0, q) +=
        wrt_position * rotated_wrt_quaternion<T>(attitude, vector3_at(x, layout_.lever));
  }
  if (layout_.focal >= 0) block.col(layout_.focal) = wrt_focal;
  rows.add_run(0, layout_.measured, block);
}

template <class T>
template <int Rows>
void CameraBlock<T>::add_position_run(const T* x, SparseRows<T, Rows>& rows,
                                      const Matrix<T, Rows, 3>& wrt_position) const {
  if (layout_.position >= 0) rows.add_run(layout_.position, wrt_position);
  if (layout_.lever < 0) return;
  const Vector<T, 4> attitude = quaternion(x);
  const Matrix3<T> turn = rotation_matrix<T>(attitude) - Matrix3<T>::Identity();
  rows.add_run(layout_.lever, Matrix<T, Rows, 3>(wrt_position * turn));
  const Vector3<T> lever = vector3_at(x, layout_.lever);
  rows.add_run(layout_.quaternion,
               Matrix<T, Rows, 4>(wrt_position * rotated_wrt_quaternion<T>(attitude, lever)));
}

template <class T>
void CameraBlock<T>::fading_limits(const MonoParameters<T>& parameters, T* limit) const {
  const FadingLimits<T> largest(parameters);
  const auto fill = [limit](int at, int count, T value) {
    for (int i = at; i < at + count; ++i) limit[i] = value;
  };
  if (layout_.position >= 0) fill(layout_.position, 3, largest.length);
  if (layout_.lever >= 0) fill(layout_.lever, 3, square(parameters.lever_sigma_m));
  fill(layout_.quaternion, 4, largest.angle);
  if (layout_.focal >= 0) fill(layout_.focal, 1, T(0));
  if (layout_.velocity >= 0) fill(layout_.velocity, 3, T(100) * largest.length);
  fill(layout_.rate, 3, T(100));
}

}  // namespace cairn::mono
