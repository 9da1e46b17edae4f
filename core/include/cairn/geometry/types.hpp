#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace cairn {

template <class T, int N>
using Vector = Eigen::Matrix<T, N, 1>;
template <class T>
using Vector2 = Vector<T, 2>;
template <class T>
using Vector3 = Vector<T, 3>;
template <class T, int R, int C>
using Matrix = Eigen::Matrix<T, R, C>;
template <class T>
using Matrix2 = Matrix<T, 2, 2>;
template <class T>
using Matrix3 = Matrix<T, 3, 3>;
/// Hamilton quaternion, w first in text and files.
template <class T>
using Quaternion = Eigen::Quaternion<T>;

}  // namespace cairn
