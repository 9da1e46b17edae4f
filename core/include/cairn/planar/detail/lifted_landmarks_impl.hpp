#pragma once

namespace cairn {

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

}  // namespace cairn

#undef CAIRN_LIFTED_TEMPLATE
#undef CAIRN_LIFTED
