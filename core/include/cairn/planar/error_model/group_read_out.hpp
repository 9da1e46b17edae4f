#pragma once

#include "cairn/planar/error_model/group.hpp"
#include "cairn/planar/error_model/group_moments.hpp"

// GroupErrorModel: pose and landmarks with their covariances.

namespace cairn {

/// Element of B W B^T.
template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
T GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::deferred_covariance(
    int i, int j) const {
  T rows[2][3] = {};
  const int index[2] = {i, j};
  for (int k = 0; k < 2; ++k) {
    if (index[k] < 3) {
      rows[k][index[k]] = T(1);
      continue;
    }
    if (index[k] < Map::vehicle_states()) continue;
    const int slot = (index[k] - Map::vehicle_states()) / LandmarkDim;
    const int axis = (index[k] - Map::vehicle_states()) % LandmarkDim;
    if (axis < 2) rows[k][0] = axis == 0 ? p_[slot][1] : -p_[slot][0];
  }
  T sum = T(0);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) sum += rows[0][a] * W_(a, b) * rows[1][b];
  }
  return sum;
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
PlanarPose<T> GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::pose()
    const {
  const T rho = exp(T(-0.5) * heading_variance());
  PlanarPose<T> pose;
  pose.position = {this->anchor_[0] + rho * x_[0], this->anchor_[1] + rho * x_[1]};
  pose.heading = heading_;
  return pose;
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
Matrix3<T> GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::own_pose_error()
    const {
  Matrix3<T> error;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) error(i, j) = P_(i, j) + W_(i, j);
  }
  return error;
}

/// Covariance over (x, y, heading) of an `error` over (heading, xi_x).
template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
Matrix3<T> GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::pose_moments(
    const Matrix3<T>& error) const {
  const T c[2] = {error(1, 0), error(2, 0)};
  const T xi[3] = {error(1, 1), error(2, 1), error(2, 2)};
  const auto m = detail::turned_point_moments(error(0, 0), x_, c, xi);
  Matrix3<T> out;
  out << m.cov[0], m.cov[1], m.with_heading[0], m.cov[1], m.cov[2], m.with_heading[1],
      m.with_heading[0], m.with_heading[1], error(0, 0);
  return out;
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
typename GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::LandmarkVector
GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::landmark_position(
    int slot) const {
  const T rho = exp(T(-0.5) * heading_variance());
  LandmarkVector p = this->mean_landmark(slot);
  for (int i = 0; i < 2; ++i) p(i) = this->anchor_[i] + rho * p_[slot][i];
  return p;
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
typename GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::LandmarkMatrix
GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::landmark_covariance(
    int slot) const {
  const int l = Map::state_of(slot);
  const T b[2] = {p_[slot][1], -p_[slot][0]};  // -J p
  const T w = W_(0, 0);
  const T c[2] = {P_(l, 0) + b[0] * w + G_(1, 0), P_(l + 1, 0) + b[1] * w + G_(2, 0)};
  const T xi[3] = {P_(l, l) + b[0] * w * b[0] + G_(1, 1), P_(l + 1, l) + b[0] * w * b[1] + G_(2, 1),
                   P_(l + 1, l + 1) + b[1] * w * b[1] + G_(2, 2)};
  const auto m = detail::turned_point_moments(heading_variance(), p_[slot], c, xi);
  LandmarkMatrix out;
  out(0, 0) = m.cov[0];
  out(0, 1) = m.cov[1];
  out(1, 0) = m.cov[1];
  out(1, 1) = m.cov[2];
  if constexpr (LandmarkDim > 2) {
    const T rho = exp(T(-0.5) * heading_variance());
    const T with_e = P_(l + 2, 0);
    const T jm[2] = {-p_[slot][1], p_[slot][0]};
    for (int i = 0; i < 2; ++i) {
      out(2, i) = P_(l + 2, l + i) + rho * jm[i] * with_e;
      out(i, 2) = out(2, i);
    }
    out(2, 2) = P_(l + 2, l + 2);
  }
  return out;
}

}  // namespace cairn
