#pragma once

namespace cairn {

/// Moments of R(e) m + xi with e ~ N(0, s2), c = Cov(xi, e), xi = Cov(xi), given as 00, 10, 11.
CAIRN_GROUP_TEMPLATE
typename CAIRN_GROUP::Moments CAIRN_GROUP::moments(const T* m, const T* c, const T* xi) const {
  const T s2 = heading_variance();
  const T rho = exp(T(-0.5) * s2);
  const T rho2 = rho * rho;
  const T rho4 = rho2 * rho2;
  const T vc = T(0.5) * (T(1) + rho4) - rho2;
  const T vs = T(0.5) * (T(1) - rho4);
  const T jm[2] = {-m[1], m[0]};
  Moments out;
  out.mean[0] = rho * m[0];
  out.mean[1] = rho * m[1];
  out.cov[0] = vc * m[0] * m[0] + vs * jm[0] * jm[0] + T(2) * rho * jm[0] * c[0] + xi[0];
  out.cov[1] = vc * m[0] * m[1] + vs * jm[0] * jm[1] + rho * (jm[0] * c[1] + jm[1] * c[0]) + xi[1];
  out.cov[2] = vc * m[1] * m[1] + vs * jm[1] * jm[1] + T(2) * rho * jm[1] * c[1] + xi[2];
  out.with_heading[0] = rho * s2 * jm[0] + c[0];
  out.with_heading[1] = rho * s2 * jm[1] + c[1];
  return out;
}

CAIRN_GROUP_TEMPLATE
PlanarPose<T> CAIRN_GROUP::pose() const {
  const T rho = exp(T(-0.5) * heading_variance());
  PlanarPose<T> pose;
  pose.position = {this->anchor_[0] + rho * this->x_[0], this->anchor_[1] + rho * this->x_[1]};
  pose.heading = this->heading_;
  return pose;
}

CAIRN_GROUP_TEMPLATE
Matrix3<T> CAIRN_GROUP::pose_covariance() const {
  const auto& P = this->P_;
  const T c[2] = {P(1, 0) + W_(1, 0), P(2, 0) + W_(2, 0)};
  const T xi[3] = {P(1, 1) + W_(1, 1), P(2, 1) + W_(2, 1), P(2, 2) + W_(2, 2)};
  const Moments m = moments(this->x_, c, xi);
  Matrix3<T> out;
  out << m.cov[0], m.cov[1], m.with_heading[0], m.cov[1], m.cov[2], m.with_heading[1],
      m.with_heading[0], m.with_heading[1], heading_variance();
  return out;
}

CAIRN_GROUP_TEMPLATE
Vector<T, LandmarkDim> CAIRN_GROUP::landmark_position(int slot) const {
  const T rho = exp(T(-0.5) * heading_variance());
  Vector<T, LandmarkDim> p = this->mean_landmark(slot);
  for (int i = 0; i < 2; ++i) p(i) = this->anchor_[i] + rho * this->p_[slot][i];
  return p;
}

CAIRN_GROUP_TEMPLATE
Matrix<T, LandmarkDim, LandmarkDim> CAIRN_GROUP::landmark_covariance(int slot) const {
  const auto& P = this->P_;
  const int l = Base::state_of(slot);
  const T b[2] = {this->p_[slot][1], -this->p_[slot][0]};  // -J p
  const T w = W_(0, 0);
  const T c[2] = {P(l, 0) + b[0] * w, P(l + 1, 0) + b[1] * w};
  const T xi[3] = {P(l, l) + b[0] * w * b[0], P(l + 1, l) + b[0] * w * b[1],
                   P(l + 1, l + 1) + b[1] * w * b[1]};
  const Moments m = moments(this->p_[slot], c, xi);
  Matrix<T, LandmarkDim, LandmarkDim> out;
  out(0, 0) = m.cov[0];
  out(0, 1) = m.cov[1];
  out(1, 0) = m.cov[1];
  out(1, 1) = m.cov[2];
  if constexpr (LandmarkDim > 2) {
    const T rho = exp(T(-0.5) * heading_variance());
    const T with_e = P(l + 2, 0);
    const T jm[2] = {-this->p_[slot][1], this->p_[slot][0]};
    for (int i = 0; i < 2; ++i) {
      out(2, i) = P(l + 2, l + i) + rho * jm[i] * with_e;
      out(i, 2) = out(2, i);
    }
    out(2, 2) = P(l + 2, l + 2);
  }
  return out;
}

/// Element of B W B^T.
CAIRN_GROUP_TEMPLATE
T CAIRN_GROUP::pending_covariance(int i, int j) const {
  T rows[2][3] = {};
  const int index[2] = {i, j};
  for (int k = 0; k < 2; ++k) {
    if (index[k] < 3) {
      rows[k][index[k]] = T(1);
      continue;
    }
    const int slot = (index[k] - 3) / LandmarkDim;
    const int axis = (index[k] - 3) % LandmarkDim;
    if (axis < 2) rows[k][0] = axis == 0 ? this->p_[slot][1] : -this->p_[slot][0];
  }
  T sum = T(0);
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) sum += rows[0][a] * W_(a, b) * rows[1][b];
  }
  return sum;
}

}  // namespace cairn

#undef CAIRN_GROUP_TEMPLATE
#undef CAIRN_GROUP
