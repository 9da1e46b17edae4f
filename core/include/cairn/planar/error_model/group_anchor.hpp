#pragma once

#include "cairn/planar/error_model/group.hpp"

// GroupErrorModel: what all its states share, the centre about which its error turns, and lateral
// slip.

namespace cairn {

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates>::share_pose_error() {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) G_(i, j) += P_(i, j);
  }
  // The tilt is the vehicle's own: it stays, and what it shares with the pose is forgotten.
  for (int i = 0; i < P_.size(); ++i) {
    const int first_kept = i < 3 ? i + 1 : 3;
    for (int j = 0; j < first_kept; ++j) P_(i, j) = T(0);
  }
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates>::slip_laterally(T variance) {
  const RelativeFrame<T> f = this->frame();
  W_(1, 1) += variance * square(f.sine);
  W_(2, 1) -= variance * f.sine * f.cosine;
  W_(2, 2) += variance * square(f.cosine);
  W_(1, 2) = W_(2, 1);
  deferred_ = true;
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates>::join_world() {
  for (int i = 0; i < P_.size(); ++i) {
    for (int j = 0; j <= i; ++j) P_(i, j) += shared_covariance(i, j);
  }
  G_.setZero();
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates>::move_anchor() {
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
