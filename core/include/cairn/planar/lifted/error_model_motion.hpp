#pragma once

#include "cairn/planar/lifted/error_model.hpp"
#include "cairn/planar/lifted/trigonometric_moments.hpp"

// LiftedErrorModel: start, prediction, pose.

namespace cairn {

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::start(const PlanarPose<T>& pose,
                                                           const Matrix3<T>& covariance) {
  landmarks_ = 0;
  P_.resize(0);
  P_.resize(kVehicle);
  if (parameters_.exact_moments) {
    initial_moments(pose, covariance);
  } else {
    initial_jacobian(pose, covariance);
  }
}

/// P(0) = J P0 J^T, rank 3. The paper leaves P(0) open.
template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::initial_jacobian(
    const PlanarPose<T>& pose, const Matrix3<T>& covariance) {
  T s = T(0);
  T c = T(1);
  sin_cos(pose.heading, s, c);
  const T x = pose.position.x();
  const T y = pose.position.y();
  T z[kVehicle];
  detail::lift_vehicle(x, y, s, c, z);
  for (int i = 0; i < kVehicle; ++i) z_[i] = z[i];
  const T jacobian[kVehicle][3] = {
      {T(1), T(0), T(0)}, {T(0), T(1), T(0)},         {T(0), T(0), c},
      {T(0), T(0), -s},   {T(0), T(0), T(2) * s * c}, {T(0), T(0), T(-2) * s * c},
      {s, T(0), x * c},   {c, T(0), -x * s},          {T(0), s, y * c},
      {T(0), c, -y * s},  {T(0), T(0), c * c - s * s}};
  for (int i = 0; i < kVehicle; ++i) {
    for (int j = 0; j <= i; ++j) {
      T sum = T(0);
      for (int a = 0; a < 3; ++a) {
        for (int b = 0; b < 3; ++b) sum += jacobian[i][a] * covariance(a, b) * jacobian[j][b];
      }
      P_(i, j) = sum;
    }
  }
}

/// Exact mean and covariance of the lifted Gaussian start.
template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::initial_moments(const PlanarPose<T>& pose,
                                                                     const Matrix3<T>& covariance) {
  using Mono = detail::TrigMonomial<T>;
  const Mono one = Mono::constant();
  const Mono s = Mono::sine(1);
  const Mono c = Mono::cosine(1);
  const Mono lifted[kVehicle] = {one.of(1), one.of(2), s,       c,       s * s, c * c,
                                 s.of(1),   c.of(1),   s.of(2), c.of(2), s * c};
  const T mean[3] = {pose.heading, pose.position.x(), pose.position.y()};
  const int from[3] = {2, 0, 1};
  T ordered[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) ordered[i][j] = covariance(from[i], from[j]);
  }
  const detail::TrigonometricMoments<T> moments(mean, ordered);
  for (int i = 0; i < kVehicle; ++i) {
    z_[i] = moments.mean(lifted[i]);
    for (int j = 0; j <= i; ++j) P_(i, j) = moments.covariance(lifted[i], lifted[j]);
  }
}

template <class T, int MaxLandmarks, int LandmarkDim>
PlanarPose<T> LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::mean_pose() const {
  PlanarPose<T> pose;
  pose.position = {z_[0], z_[1]};
  pose.heading = atan2(z_[2], z_[3]);
  return pose;
}

template <class T, int MaxLandmarks, int LandmarkDim>
Matrix3<T> LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::pose_covariance() const {
  const T norm = z_[2] * z_[2] + z_[3] * z_[3];
  const T by_s = z_[3] / norm;
  const T by_c = -z_[2] / norm;
  Matrix3<T> out;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) out(i, j) = P_(i, j);
    out(i, 2) = by_s * P_(i, 2) + by_c * P_(i, 3);
    out(2, i) = out(i, 2);
  }
  out(2, 2) = by_s * by_s * P_(2, 2) + T(2) * by_s * by_c * P_(3, 2) + by_c * by_c * P_(3, 3);
  return out;
}

template <class T, int MaxLandmarks, int LandmarkDim>
Vector<T, LandmarkDim> LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::mean_landmark(
    int slot) const {
  const T* zi = z_ + state_of(slot);
  Vector<T, LandmarkDim> p;
  p(0) = zi[0];
  p(1) = zi[1];
  if constexpr (LandmarkDim > 2) p(2) = zi[kLandmark - 1];
  return p;
}

template <class T, int MaxLandmarks, int LandmarkDim>
Matrix<T, LandmarkDim, LandmarkDim>
LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::landmark_covariance(int slot) const {
  const int first = state_of(slot);
  const int index[3] = {first, first + 1, first + kLandmark - 1};
  Matrix<T, LandmarkDim, LandmarkDim> out;
  for (int i = 0; i < LandmarkDim; ++i) {
    for (int j = 0; j < LandmarkDim; ++j) out(i, j) = P_(index[i], index[j]);
  }
  return out;
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::transition(const detail::Monomials<T>& m,
                                                                int block, const T* in,
                                                                T* out) const {
  if (block == 0) {
    detail::vehicle_transition(m, in, out);
    return;
  }
  detail::landmark_transition(m, in, out, parameters_.misprints);
  if constexpr (LandmarkDim > 2) out[kLandmark - 1] = m.m[detail::kOne] * in[kLandmark - 1];
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::transition_all(const detail::Monomials<T>& m,
                                                                    const T* in, T* out) const {
  for (int block = 0; block <= landmarks_; ++block) {
    const int first = block_start(block);
    transition(m, block, in + first, out + first);
  }
}

/// out = A_row in A_column^T of one block, (17) and (19) with the cross blocks.
template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::transition_block(
    const detail::Monomials<T>& m, int row_block, int column_block,
    const T (&in)[kVehicle][kVehicle], T (&out)[kVehicle][kVehicle]) const {
  const int rows = block_size(row_block);
  const int columns = block_size(column_block);
  T half[kVehicle][kVehicle];
  for (int i = 0; i < rows; ++i) transition(m, column_block, in[i], half[i]);
  for (int j = 0; j < columns; ++j) {
    T column[kVehicle];
    T moved[kVehicle];
    for (int i = 0; i < rows; ++i) column[i] = half[i][j];
    transition(m, row_block, column, moved);
    for (int i = 0; i < rows; ++i) out[i][j] = moved[i];
  }
}

/// P = A(mean) P A(mean)^T + sum_r A(noise_r) (P + z z^T) A(noise_r)^T, block by block in place.
template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::transform_covariance(
    const detail::Monomials<T>& mean, const detail::Monomials<T>* noise, int noise_count) {
  T in[kVehicle][kVehicle];
  T sum[kVehicle][kVehicle];
  T part[kVehicle][kVehicle];
  for (int row_block = 0; row_block <= landmarks_; ++row_block) {
    const int row = block_start(row_block);
    const int rows = block_size(row_block);
    for (int column_block = 0; column_block <= row_block; ++column_block) {
      const int column = block_start(column_block);
      const int columns = block_size(column_block);
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) in[i][j] = P_(row + i, column + j);
      }
      transition_block(mean, row_block, column_block, in, sum);
      if (noise_count > 0) {
        for (int i = 0; i < rows; ++i) {
          for (int j = 0; j < columns; ++j) in[i][j] += z_[row + i] * z_[column + j];
        }
      }
      for (int r = 0; r < noise_count; ++r) {
        transition_block(noise[r], row_block, column_block, in, part);
        for (int i = 0; i < rows; ++i) {
          for (int j = 0; j < columns; ++j) sum[i][j] += part[i][j];
        }
      }
      for (int i = 0; i < rows; ++i) {
        const int last = row_block == column_block ? i + 1 : columns;
        for (int j = 0; j < last; ++j) P_(row + i, column + j) = sum[i][j];
      }
    }
  }
}

/// (16) to (19): mean by the lifted transition, noise by the Jacobians, all blocks driven by the
/// same noise.
template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::propagate(
    const PlanarIncrement<T>& increment) {
  if (parameters_.exact_moments) {
    propagate_moments(increment);
    return;
  }
  const Displacement<T> u = displacement(increment);
  T s = T(0);
  T c = T(1);
  sin_cos(increment.turn_rad, s, c);
  const detail::Monomials<T> mean = detail::monomials(u, s, c);
  T* by_distance = scratch_[0];
  T* by_turn = scratch_[1];
  transition_all(detail::monomials_by_distance(u, s, c), z_, by_distance);
  transition_all(detail::monomials_by_turn(u, s, c), z_, by_turn);
  transform_covariance(mean, nullptr, 0);
  const Matrix2<T>& q = increment.covariance;
  P_.downdate(by_distance, by_turn, -q(0, 0), -q(0, 1), -q(1, 1));
  transition_all(mean, z_, z_);
}

/// The same with exact moments: the noise multiplies the state, so it also meets P.
template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::propagate_moments(
    const PlanarIncrement<T>& increment) {
  using Mono = detail::TrigMonomial<T>;
  // In the half angle, so that the chord of the exact arc is a monomial too.
  const bool arc = increment.model == IncrementModel::kExactArc;
  const Mono s = Mono::sine(2);
  const Mono c = Mono::cosine(2);
  const Mono ux = (arc ? Mono::cosine(1) : Mono::constant()).of(1);
  const Mono uy = (arc ? Mono::sine(1) : Mono{}).of(1);
  const Mono list[detail::kMonomials] = {Mono::constant(), ux,     uy,     s,     c,     ux * s,
                                         ux * c,           uy * s, uy * c, s * s, c * c, s * c};
  const Matrix2<T>& q = increment.covariance;
  const T mean[3] = {T(0.5) * increment.turn_rad, increment.distance_m, T(0)};
  const T covariance[3][3] = {{T(0.25) * q(1, 1), T(0.5) * q(0, 1), T(0)},
                              {T(0.5) * q(0, 1), q(0, 0), T(0)},
                              {T(0), T(0), T(0)}};
  const detail::TrigonometricMoments<T> moments(mean, covariance);
  detail::Monomials<T> expected;
  T spread[detail::kMonomials][detail::kMonomials];
  for (int i = 0; i < detail::kMonomials; ++i) {
    expected.m[i] = moments.mean(list[i]);
    for (int j = 0; j <= i; ++j) {
      spread[i][j] = moments.covariance(list[i], list[j]);
      spread[j][i] = spread[i][j];
    }
  }
  T columns[detail::kMonomials][detail::kMonomials];
  const T tolerance = sizeof(T) == sizeof(float) ? T(1e-6) : T(1e-14);
  const int rank = detail::semidefinite_factor(spread, tolerance, columns);
  detail::Monomials<T> noise[detail::kMonomials];
  for (int r = 0; r < rank; ++r) {
    for (int i = 0; i < detail::kMonomials; ++i) noise[r].m[i] = columns[r][i];
  }
  transform_covariance(expected, noise, rank);
  transition_all(expected, z_, z_);
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::widen_pose(T position_variance,
                                                                T heading_variance) {
  detail::Monomials<T> forward;
  forward.m[detail::kUx] = T(1);
  forward.m[detail::kUxC] = T(1);
  detail::Monomials<T> left;
  left.m[detail::kUy] = T(1);
  left.m[detail::kUyC] = T(1);
  detail::Monomials<T> turn;
  turn.m[detail::kS] = T(1);
  turn.m[detail::kSC] = T(1);
  transition_all(forward, z_, scratch_[0]);
  transition_all(left, z_, scratch_[1]);
  transition_all(turn, z_, scratch_[2]);
  P_.downdate(scratch_[0], scratch_[1], -position_variance, T(0), -position_variance);
  P_.downdate(scratch_[2], -heading_variance);
}

template <class T, int MaxLandmarks, int LandmarkDim>
void LiftedErrorModel<T, MaxLandmarks, LandmarkDim>::slip_laterally(T variance) {
  detail::Monomials<T> left;
  left.m[detail::kUy] = T(1);
  left.m[detail::kUyC] = T(1);
  transition_all(left, z_, scratch_[1]);
  P_.downdate(scratch_[1], -variance);
}

}  // namespace cairn
