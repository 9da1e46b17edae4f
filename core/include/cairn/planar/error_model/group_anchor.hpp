#pragma once

#include "cairn/planar/error_model/group.hpp"

// GroupErrorModel: what all its states share, the centre about which its error turns, lateral slip,
// and the direction of travel.

namespace cairn {

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::share_pose_error() {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) G_(i, j) += P_(i, j);
  }
  // The tilt is the vehicle's own: it stays, and what it shares with the pose is forgotten.
  for (int i = 0; i < P_.size(); ++i) {
    const int first_kept = i < 3 ? i + 1 : 3;
    for (int j = 0; j < first_kept; ++j) P_(i, j) = T(0);
  }
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::slip_laterally(
    T variance) {
  const RelativeFrame<T> f = this->frame();
  W_(1, 1) += variance * square(f.sine);
  W_(2, 1) -= variance * f.sine * f.cosine;
  W_(2, 2) += variance * square(f.cosine);
  W_(1, 2) = W_(2, 1);
  deferred_ = true;
}

/// Along the direction of travel b beside the x axis, u += d b s with s across the step. The error
/// of b goes to xi_x as d R s, whatever the heading is: rows 1 and 2 of P take those of b. Cost:
/// 2 n multiply-adds.
template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::travel_beside(
    T distance_m, const RelativeFrame<T>& frame, Displacement<T>& u) {
  const Vector2<T> across(-u.by_distance.y(), u.by_distance.x());
  u.u += (distance_m * this->travel_rad_) * across;
  u.by_distance += this->travel_rad_ * across;
  if (distance_m == T(0)) return;
  T by[2];
  frame.to_relative(across.data(), by);
  for (T& b : by) b *= distance_m;
  const int t = Map::travel_state();
  const T with_position[2] = {P_(t, 1), P_(t, 2)};
  const T half[2] = {with_position[0] + T(0.5) * by[0] * P_(t, t),
                     with_position[1] + T(0.5) * by[1] * P_(t, t)};
  for (int i = 0; i < 2; ++i) {
    P_(1 + i, 0) += by[i] * P_(t, 0);
    for (int j = 0; j <= i; ++j) P_(1 + i, 1 + j) += by[i] * half[j] + half[i] * by[j];
  }
  for (int k = 3; k < P_.size(); ++k) {
    const T with_travel = P_(k, t);
    T* row = P_.row(k);
    row[1] += by[0] * with_travel;
    row[2] += by[1] * with_travel;
  }
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::join_world() {
  for (int i = 0; i < P_.size(); ++i) {
    for (int j = 0; j <= i; ++j) P_(i, j) += shared_covariance(i, j);
  }
  G_.setZero();
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::move_anchor() {
  const T by_heading[2] = {-x_[1], x_[0]};
  const int n = P_.size();
  T c[Map::kStates] = {};
  for (int i = 0; i < 2; ++i) c[kPositionState + i] = by_heading[i];
  for (int slot = 0; slot < this->landmark_count(); ++slot) {
    for (int i = 0; i < 2; ++i) {
      c[Map::state_of(slot) + i] = by_heading[i];
      p_[slot][i] -= x_[i];
    }
  }
  // P += c r^T + r c^T with r = P e_0 + P_00 c / 2.
  for (int i = 0; i < n; ++i) along_[i] = P_(i, 0) + T(0.5) * P_(0, 0) * c[i];
  P_.downdate(c, along_, T(0), T(-1), T(0));
  // The same for what all states share, and what waits.
  for (Matrix3<T>* shared : {&W_, &G_}) {
    Matrix3<T>& m = *shared;
    T r[3];
    for (int i = 0; i < 3; ++i) r[i] = m(i, 0) + T(0.5) * m(0, 0) * c[i];
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) {
        m(i, j) += c[i] * r[j] + r[i] * c[j];
        m(j, i) = m(i, j);
      }
    }
  }
  for (int i = 0; i < 2; ++i) {
    this->anchor_[i] += x_[i];
    x_[i] = T(0);
  }
}

}  // namespace cairn
