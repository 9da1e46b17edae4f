#pragma once

#include "cairn/planar/detail/trigonometric_moments.hpp"

namespace cairn {

#define CAIRN_LIFTED_TEMPLATE template <class T, int MaxLandmarks, int LandmarkDim>
#define CAIRN_LIFTED LiftedIekfSlam<T, MaxLandmarks, LandmarkDim>

CAIRN_LIFTED_TEMPLATE
Status CAIRN_LIFTED::initialise(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                                const PlanarParameters<T>& parameters) {
  const Status status = this->begin(pose, covariance, parameters);
  if (!ok(status)) return status;
  if (parameters.exact_moments) {
    initial_moments(pose, covariance);
  } else {
    initial_jacobian(pose, covariance);
  }
  return Status::kOk;
}

/// P(0) = J P0 J^T, rank 3. The paper leaves P(0) open.
CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::initial_jacobian(const PlanarPose<T>& pose, const Matrix3<T>& covariance) {
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
      this->P_(i, j) = sum;
    }
  }
}

/// Exact mean and covariance of the lifted Gaussian start.
CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::initial_moments(const PlanarPose<T>& pose, const Matrix3<T>& covariance) {
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
    for (int j = 0; j <= i; ++j) this->P_(i, j) = moments.covariance(lifted[i], lifted[j]);
  }
}

CAIRN_LIFTED_TEMPLATE
PlanarPose<T> CAIRN_LIFTED::pose() const {
  PlanarPose<T> pose;
  pose.position = {z_[0], z_[1]};
  pose.heading = atan2(z_[2], z_[3]);
  return pose;
}

CAIRN_LIFTED_TEMPLATE
Matrix3<T> CAIRN_LIFTED::pose_covariance() const {
  const T norm = z_[2] * z_[2] + z_[3] * z_[3];
  const T by_s = z_[3] / norm;
  const T by_c = -z_[2] / norm;
  const auto& P = this->P_;
  Matrix3<T> out;
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) out(i, j) = P(i, j);
    out(i, 2) = by_s * P(i, 2) + by_c * P(i, 3);
    out(2, i) = out(i, 2);
  }
  out(2, 2) = by_s * by_s * P(2, 2) + T(2) * by_s * by_c * P(3, 2) + by_c * by_c * P(3, 3);
  return out;
}

CAIRN_LIFTED_TEMPLATE
Vector<T, LandmarkDim> CAIRN_LIFTED::landmark_position(int slot) const {
  const T* zi = z_ + Base::state_of(slot);
  Vector<T, LandmarkDim> p;
  p(0) = zi[0];
  p(1) = zi[1];
  if constexpr (LandmarkDim > 2) p(2) = zi[kLandmark - 1];
  return p;
}

CAIRN_LIFTED_TEMPLATE
Matrix<T, LandmarkDim, LandmarkDim> CAIRN_LIFTED::landmark_covariance(int slot) const {
  const int first = Base::state_of(slot);
  const int index[3] = {first, first + 1, first + kLandmark - 1};
  Matrix<T, LandmarkDim, LandmarkDim> out;
  for (int i = 0; i < LandmarkDim; ++i) {
    for (int j = 0; j < LandmarkDim; ++j) out(i, j) = this->P_(index[i], index[j]);
  }
  return out;
}

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::hash(Hash64& hash) const {
  for (int i = 0; i < this->P_.size(); ++i) hash.add(z_[i]);
  this->hash_common(hash);
}

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::transition(const detail::Monomials<T>& m, int block, const T* in, T* out) const {
  if (block == 0) {
    detail::vehicle_transition(m, in, out);
    return;
  }
  detail::landmark_transition(m, in, out, this->parameters_.misprints);
  if constexpr (LandmarkDim > 2) out[kLandmark - 1] = m.m[detail::kOne] * in[kLandmark - 1];
}

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::transition_all(const detail::Monomials<T>& m, const T* in, T* out) const {
  for (int block = 0; block <= this->table_.size(); ++block) {
    const int first = block_start(block);
    transition(m, block, in + first, out + first);
  }
}

/// out = A_row in A_column^T of one block, (17) and (19) with the cross blocks.
CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::transition_block(const detail::Monomials<T>& m, int row_block, int column_block,
                                    const T (&in)[kVehicle][kVehicle],
                                    T (&out)[kVehicle][kVehicle]) const {
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
CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::transform_covariance(const detail::Monomials<T>& mean,
                                        const detail::Monomials<T>* noise, int noise_count) {
  auto& P = this->P_;
  T in[kVehicle][kVehicle];
  T sum[kVehicle][kVehicle];
  T part[kVehicle][kVehicle];
  for (int row_block = 0; row_block <= this->table_.size(); ++row_block) {
    const int row = block_start(row_block);
    const int rows = block_size(row_block);
    for (int column_block = 0; column_block <= row_block; ++column_block) {
      const int column = block_start(column_block);
      const int columns = block_size(column_block);
      for (int i = 0; i < rows; ++i) {
        for (int j = 0; j < columns; ++j) in[i][j] = P(row + i, column + j);
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
        for (int j = 0; j < last; ++j) P(row + i, column + j) = sum[i][j];
      }
    }
  }
}

/// (16) to (19): mean by the lifted transition, noise by the Jacobians, all blocks driven by the
/// same noise.
CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::propagate(const PlanarIncrement<T>& increment) {
  if (this->parameters_.exact_moments) {
    propagate_moments(increment);
    return;
  }
  const Displacement<T> u = displacement(increment);
  T s = T(0);
  T c = T(1);
  sin_cos(increment.turn_rad, s, c);
  const detail::Monomials<T> mean = detail::monomials(u, s, c);
  T* by_distance = this->w_[0];
  T* by_turn = this->w_[1];
  transition_all(detail::monomials_by_distance(u, s, c), z_, by_distance);
  transition_all(detail::monomials_by_turn(u, s, c), z_, by_turn);
  transform_covariance(mean, nullptr, 0);
  const Matrix2<T>& q = increment.covariance;
  this->P_.downdate(by_distance, by_turn, -q(0, 0), -q(0, 1), -q(1, 1));
  transition_all(mean, z_, z_);
}

/// The same with exact moments: the noise multiplies the state, so it also meets P.
CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::propagate_moments(const PlanarIncrement<T>& increment) {
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

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::widen_pose_by(T position_variance, T heading_variance) {
  detail::Monomials<T> forward;
  forward.m[detail::kUx] = T(1);
  forward.m[detail::kUxC] = T(1);
  detail::Monomials<T> left;
  left.m[detail::kUy] = T(1);
  left.m[detail::kUyC] = T(1);
  detail::Monomials<T> turn;
  turn.m[detail::kS] = T(1);
  turn.m[detail::kSC] = T(1);
  transition_all(forward, z_, this->w_[0]);
  transition_all(left, z_, this->w_[1]);
  transition_all(turn, z_, this->w_[2]);
  this->P_.downdate(this->w_[0], this->w_[1], -position_variance, T(0), -position_variance);
  this->P_.downdate(this->w_[2], -heading_variance);
}

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::widen_landmark_by(int slot, T variance) {
  const int first = Base::state_of(slot);
  const T by_x[detail::kLiftedLandmark] = {T(1), T(0), z_[2], z_[3], T(0), T(0)};
  const T by_y[detail::kLiftedLandmark] = {T(0), T(1), T(0), T(0), z_[2], z_[3]};
  for (int i = 0; i < detail::kLiftedLandmark; ++i) {
    for (int j = 0; j <= i; ++j) {
      this->P_(first + i, first + j) += variance * (by_x[i] * by_x[j] + by_y[i] * by_y[j]);
    }
  }
  if constexpr (LandmarkDim > 2) {
    this->P_(first + kLandmark - 1, first + kLandmark - 1) += variance;
  }
}

/// (26) to (28). Errata: the noise block of (27) is the 2x2 covariance of the observation, and
/// G_new of (28) is 6x2.
CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::append_landmark(const Vector<T, LandmarkDim>& y,
                                   const Matrix<T, LandmarkDim, LandmarkDim>& R) {
  constexpr int kPlane = detail::kLiftedLandmark;
  const unsigned misprints = this->parameters_.misprints;
  auto& P = this->P_;
  const int first = P.size();
  P.resize(first + kLandmark);
  T* zi = z_ + first;
  detail::new_landmark(z_, y(0), y(1), zi, misprints);
  if constexpr (LandmarkDim > 2) zi[kLandmark - 1] = y(2);

  T column[kVehicle];
  T moved[kPlane];
  for (int j = 0; j < first; ++j) {
    for (int i = 0; i < kVehicle; ++i) column[i] = P(i, j);
    detail::new_landmark(column, y(0), y(1), moved, misprints);
    for (int i = 0; i < kPlane; ++i) P(first + i, j) = moved[i];
  }
  T g[2][kPlane];
  detail::new_landmark_by_observation(z_, g[0], g[1], misprints);
  for (int j = 0; j < kPlane; ++j) {
    for (int i = 0; i < kVehicle; ++i) column[i] = P(first + j, i);
    detail::new_landmark(column, y(0), y(1), moved, misprints);
    for (int i = j; i < kPlane; ++i) {
      T noise = T(0);
      for (int a = 0; a < 2; ++a) {
        for (int b = 0; b < 2; ++b) noise += g[a][i] * R(a, b) * g[b][j];
      }
      P(first + i, first + j) = moved[i] + noise;
    }
  }
  if (this->parameters_.exact_moments) {
    // + sum_ab R_ab B_a P B_b^T: the observation's noise meets the vehicle's uncertainty.
    T by[2][kVehicle][kPlane];  // row i of P_RR times B_a^T
    for (int i = 0; i < kVehicle; ++i) {
      for (int k = 0; k < kVehicle; ++k) column[k] = P(i, k);
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
          for (int b = 0; b < 2; ++b) P(first + i, first + j) += R(a, b) * both[a][b][i];
        }
      }
    }
  }
  if constexpr (LandmarkDim > 2) {
    const int height = first + kLandmark - 1;
    for (int j = 0; j < kPlane; ++j) {
      P(height, first + j) = R(2, 0) * g[0][j] + R(2, 1) * g[1][j];
    }
    P(height, height) = R(2, 2);
  }
}

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::remove_slot(int slot) {
  const int to = Base::state_of(slot);
  const int from = Base::state_of(this->table_.size() - 1);
  for (int i = 0; i < kLandmark; ++i) z_[to + i] = z_[from + i];
  this->P_.remove_block_unordered(to, kLandmark);
}

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::relative_of(int slot, const T* v, T* out) const {
  const T* vi = v + Base::state_of(slot);
  detail::lifted_relative(v, vi, out);
  if constexpr (LandmarkDim > 2) out[2] = vi[kLandmark - 1];
}

CAIRN_LIFTED_TEMPLATE
Status CAIRN_LIFTED::add_position(LandmarkId id) {
  constexpr T kTiny = T(1e-8);
  const Status status = this->add_landmark(id, Vector<T, LandmarkDim>::Zero(),
                                           kTiny * Matrix<T, LandmarkDim, LandmarkDim>::Identity());
  if (ok(status)) this->table_.statistics(this->table_.size() - 1).pinned = true;
  return status;
}

CAIRN_LIFTED_TEMPLATE
Status CAIRN_LIFTED::add_landmark_on_path(LandmarkId id, const Vector<T, LandmarkDim>& y_vehicle,
                                          const Matrix<T, LandmarkDim, LandmarkDim>& R,
                                          LandmarkId past, const Matrix<T, LandmarkDim, 2>& by_path,
                                          LandmarkId* replaced) {
  const int slot = this->find(past);
  if (slot < 0) return Status::kNotFound;
  detail::RelativeCovariance<T> way;
  relative_covariance(slot, way);
  Matrix2<T> covariance;
  covariance << way.s[0], way.s[1], way.s[1], way.s[2];
  const Matrix<T, LandmarkDim, 2> half = by_path * covariance;
  return this->add_landmark(
      id, y_vehicle, Matrix<T, LandmarkDim, LandmarkDim>(R + half * by_path.transpose()), replaced);
}

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::relative_covariance(int slot, detail::RelativeCovariance<T>& out) const {
  const int l = Base::state_of(slot);
  const int index[3][4] = {
      {7, 8, l + 3, l + 4}, {6, 9, l + 2, l + 5}, {l + kLandmark - 1, 0, 0, 0}};
  const T sign[3][4] = {
      {T(-1), T(-1), T(1), T(1)}, {T(1), T(-1), T(-1), T(1)}, {T(1), T(0), T(0), T(0)}};
  for (int i = 0; i < LandmarkDim; ++i) {
    for (int j = 0; j <= i; ++j) {
      T sum = T(0);
      for (int a = 0; a < 4; ++a) {
        for (int b = 0; b < 4; ++b) {
          sum += sign[i][a] * sign[j][b] * this->P_(index[i][a], index[j][b]);
        }
      }
      out.s[i * (i + 1) / 2 + j] = sum;
    }
  }
}

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::relative_columns(int slot, T* c0, T* c1, T* c2) const {
  const int l = Base::state_of(slot);
  const int x[4] = {7, 8, l + 3, l + 4};
  const T sign_x[4] = {T(-1), T(-1), T(1), T(1)};
  const int y[4] = {6, 9, l + 2, l + 5};
  const T sign_y[4] = {T(1), T(-1), T(-1), T(1)};
  this->P_.multiply_sparse(x, sign_x, 4, c0);
  this->P_.multiply_sparse(y, sign_y, 4, c1);
  if (c2 == nullptr) return;
  const int height[1] = {l + kLandmark - 1};
  const T one[1] = {T(1)};
  this->P_.multiply_sparse(height, one, 1, c2);
}

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::relative_after(int slot, const T* d, const Trial&, T* out) const {
  T change[LandmarkDim];
  relative_of(slot, z_, out);
  relative_of(slot, d, change);
  for (int i = 0; i < LandmarkDim; ++i) out[i] += change[i];
}

CAIRN_LIFTED_TEMPLATE
void CAIRN_LIFTED::correct(const T* d) {
  for (int i = 0; i < this->P_.size(); ++i) z_[i] += d[i];
}

#undef CAIRN_LIFTED_TEMPLATE
#undef CAIRN_LIFTED

}  // namespace cairn
