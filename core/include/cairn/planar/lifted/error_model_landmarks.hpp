#pragma once

#include "cairn/planar/lifted/error_model.hpp"

// LiftedErrorModel: landmarks and their relative vectors.

namespace cairn {

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::widen_landmark(int slot, T variance) {
  const int first = state_of(slot);
  const T by_x[detail::kLiftedLandmark] = {T(1), T(0), z_[2], z_[3], T(0), T(0)};
  const T by_y[detail::kLiftedLandmark] = {T(0), T(1), T(0), T(0), z_[2], z_[3]};
  for (int i = 0; i < detail::kLiftedLandmark; ++i) {
    for (int j = 0; j <= i; ++j) {
      P_(first + i, first + j) += variance * (by_x[i] * by_x[j] + by_y[i] * by_y[j]);
    }
  }
  if constexpr (LandmarkDim > 2) {
    P_(first + kLandmark - 1, first + kLandmark - 1) += variance;
  }
}

/// (26) to (28). Errata: the noise block of (27) is the 2x2 covariance of the observation, and
/// G_new of (28) is 6x2.
template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::append_landmark(
    const Vector<T, LandmarkDim>& y, const Matrix<T, LandmarkDim, LandmarkDim>& R) {
  constexpr int kPlane = detail::kLiftedLandmark;
  const unsigned misprints = parameters_.misprints;
  const int first = P_.size();
  P_.resize(first + kLandmark);
  ++landmarks_;
  T* zi = z_ + first;
  detail::new_landmark(z_, y(0), y(1), zi, misprints);
  if constexpr (LandmarkDim > 2) zi[kLandmark - 1] = y(2);

  T column[kVehicle];
  T moved[kPlane];
  for (int j = 0; j < first; ++j) {
    for (int i = 0; i < kVehicle; ++i) column[i] = P_(i, j);
    detail::new_landmark(column, y(0), y(1), moved, misprints);
    for (int i = 0; i < kPlane; ++i) P_(first + i, j) = moved[i];
  }
  T g[2][kPlane];
  detail::new_landmark_by_observation(z_, g[0], g[1], misprints);
  for (int j = 0; j < kPlane; ++j) {
    for (int i = 0; i < kVehicle; ++i) column[i] = P_(first + j, i);
    detail::new_landmark(column, y(0), y(1), moved, misprints);
    for (int i = j; i < kPlane; ++i) {
      T noise = T(0);
      for (int a = 0; a < 2; ++a) {
        for (int b = 0; b < 2; ++b) noise += g[a][i] * R(a, b) * g[b][j];
      }
      P_(first + i, first + j) = moved[i] + noise;
    }
  }
  if (parameters_.exact_moments) {
    // + sum_ab R_ab B_a P B_b^T: the observation's noise meets the vehicle's uncertainty.
    T by[2][kVehicle][kPlane];  // row i of P_RR times B_a^T
    for (int i = 0; i < kVehicle; ++i) {
      for (int k = 0; k < kVehicle; ++k) column[k] = P_(i, k);
      detail::new_landmark_by_observation(column, by[0][i], by[1][i], misprints);
    }
    for (int j = 0; j < kPlane; ++j) {
      T both[2][2][kPlane];
      for (int b = 0; b < 2; ++b) {
        for (int i = 0; i < kVehicle; ++i) column[i] = by[b][i][j];
        detail::new_landmark_by_observation(column, both[0][b], both[1][b], misprints);
      }
      for (int i = j; i < kPlane; ++i) {
        for (int a = 0; a < 2; ++a) {
          for (int b = 0; b < 2; ++b) P_(first + i, first + j) += R(a, b) * both[a][b][i];
        }
      }
    }
  }
  if constexpr (LandmarkDim > 2) {
    const int height = first + kLandmark - 1;
    for (int j = 0; j < kPlane; ++j) {
      P_(height, first + j) = R(2, 0) * g[0][j] + R(2, 1) * g[1][j];
    }
    P_(height, height) = R(2, 2);
  }
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::remove_landmark(int slot) {
  const int to = state_of(slot);
  const int from = state_of(landmarks_ - 1);
  for (int i = 0; i < kLandmark; ++i) z_[to + i] = z_[from + i];
  P_.remove_block_unordered(to, kLandmark);
  --landmarks_;
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::relative_of(int slot, const T* v,
                                                                 T* out) const {
  const T* vi = v + state_of(slot);
  detail::lifted_relative(v, vi, out);
  if constexpr (LandmarkDim > 2) out[2] = vi[kLandmark - 1];
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::append_position() {
  constexpr T kTiny = T(1e-8);
  append_landmark(LandmarkVector::Zero(), kTiny * LandmarkMatrix::Identity());
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::append_landmark_on_path(
    const LandmarkVector& y, const LandmarkMatrix& R, int past,
    const Matrix<T, LandmarkDim, 2>& by_path) {
  RelativeCovariance<T> path;
  relative_covariance(past, path);
  // The path's covariance is a difference, of variances up to 1e10 m^2: what comes out indefinite
  // by rounding counts as the nearest that is not. Its factor leaves no variance below 0.
  const T xx = path.s[0] > T(0) ? path.s[0] : T(0);
  const T yy = path.s[2] > T(0) ? path.s[2] : T(0);
  const T most = sqrt(xx) * sqrt(yy);
  const T xy = clamp(path.s[1], -most, most);
  Matrix2<T> factor = Matrix2<T>::Zero();
  factor(0, 0) = sqrt(xx);
  factor(1, 0) = xx > T(0) ? xy / factor(0, 0) : T(0);
  const T rest = yy - square(factor(1, 0));
  factor(1, 1) = rest > T(0) ? sqrt(rest) : T(0);
  const Matrix<T, LandmarkDim, 2> half = by_path * factor;
  append_landmark(y, LandmarkMatrix(R + half * half.transpose()));
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::relative_covariance(
    int slot, RelativeCovariance<T>& out) const {
  const int l = state_of(slot);
  const int index[3][4] = {
      {7, 8, l + 3, l + 4}, {6, 9, l + 2, l + 5}, {l + kLandmark - 1, 0, 0, 0}};
  const T sign[3][4] = {
      {T(-1), T(-1), T(1), T(1)}, {T(1), T(-1), T(-1), T(1)}, {T(1), T(0), T(0), T(0)}};
  for (int i = 0; i < LandmarkDim; ++i) {
    for (int j = 0; j <= i; ++j) {
      T sum = T(0);
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) {
          sum += sign[i][a] * sign[j][b] * P_(index[i][a], index[j][b]);
        }
      }
      out.s[i * (i + 1) / 2 + j] = sum;
    }
  }
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::relative_columns(int slot, T* c0,
                                                                      T* c1) const {
  const int l = state_of(slot);
  const int x[4] = {7, 8, l + 3, l + 4};
  const T sign_x[4] = {T(-1), T(-1), T(1), T(1)};
  const int y[4] = {6, 9, l + 2, l + 5};
  const T sign_y[4] = {T(1), T(-1), T(-1), T(1)};
  P_.multiply_sparse(x, sign_x, 4, c0);
  P_.multiply_sparse(y, sign_y, 4, c1);
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::relative_after(int slot, const T* d,
                                                                    const Retraction&,
                                                                    T* out) const {
  T change[LandmarkDim];
  relative_of(slot, z_, out);
  relative_of(slot, d, change);
  for (int i = 0; i < LandmarkDim; ++i) out[i] += change[i];
}

}  // namespace cairn
