#pragma once

namespace cairn {

// Error order: 0 e (heading), 1, 2 xi_x, then xi_i. J = [0 -1; 1 0]. P + B W B^T is the covariance,
// B = [I3; -J p_i, 0]; W gathers g Q g^T with g = [0 1; R u_d, R u_a - J x']. Rows of the relative
// vector in the world's axes: C = [0, -I, +I].

#define CAIRN_GROUP_TEMPLATE template <class T, int MaxLandmarks, int LandmarkDim>
#define CAIRN_GROUP GroupIekfSlam<T, MaxLandmarks, LandmarkDim>

CAIRN_GROUP_TEMPLATE
Status CAIRN_GROUP::initialise(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                               const PlanarParameters<T>& parameters) {
  const Status status = this->begin(pose, covariance, parameters);
  if (!ok(status)) return status;
  // Anchored at the estimate, x^ = 0 and xi_x is the plain position error.
  this->heading_ = wrap_angle(pose.heading);
  for (int i = 0; i < 2; ++i) {
    this->x_[i] = T(0);
    this->anchor_[i] = pose.position(i);
  }
  const int from[3] = {2, 0, 1};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) this->P_(i, j) = covariance(from[i], from[j]);
  }
  W_.setZero();
  pending_ = false;
  return Status::kOk;
}

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

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::propagate(const PlanarIncrement<T>& increment) {
  const detail::RelativeFrame<T> f = this->frame();
  const Displacement<T> u = displacement(increment);
  T step[2];
  T by_distance[2];
  T by_turn[2];
  f.to_relative(u.u.data(), step);
  f.to_relative(u.by_distance.data(), by_distance);
  f.to_relative(u.by_turn.data(), by_turn);
  this->x_[0] += step[0];
  this->x_[1] += step[1];
  this->heading_ = wrap_angle(this->heading_ + increment.turn_rad);

  const T g[3][2] = {{T(0), T(1)},
                     {by_distance[0], by_turn[0] + this->x_[1]},
                     {by_distance[1], by_turn[1] - this->x_[0]}};
  const Matrix2<T>& q = increment.covariance;
  for (int i = 0; i < 3; ++i) {
    const T gq0 = g[i][0] * q(0, 0) + g[i][1] * q(1, 0);
    const T gq1 = g[i][0] * q(0, 1) + g[i][1] * q(1, 1);
    for (int j = 0; j <= i; ++j) W_(i, j) += gq0 * g[j][0] + gq1 * g[j][1];
  }
  W_(0, 1) = W_(1, 0);
  W_(0, 2) = W_(2, 0);
  W_(1, 2) = W_(2, 1);
  pending_ = true;
}

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::widen_pose_by(T position_variance, T heading_variance) {
  const T g[3] = {T(1), this->x_[1], -this->x_[0]};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) W_(i, j) += g[i] * heading_variance * g[j];
  }
  W_(1, 1) += position_variance;
  W_(2, 2) += position_variance;
  pending_ = true;
}

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::begin_update() {
  if (!pending_) return;
  b_[0] = T(1);
  b_[1] = T(0);
  b_[2] = T(0);
  const int count = this->table_.size();
  T* b = b_ + Base::state_of(0);
  for (int slot = 0; slot < count; ++slot) {
    b[0] = this->p_[slot][1];
    b[1] = -this->p_[slot][0];
    if constexpr (LandmarkDim > 2) b[2] = T(0);
    b += LandmarkDim;
  }
  const T w = -W_(0, 0);
  const int n = this->P_.size();
  for (int i = 0; i < n; ++i) wb_[i] = w * b_[i];
  wb_[1] = -W_(0, 1);
  wb_[2] = -W_(0, 2);
}

/// B W B^T as one asymmetric product over the lower triangle; rows 1 and 2 follow in
/// pending_done().
CAIRN_GROUP_TEMPLATE
int CAIRN_GROUP::pending(const T** rows, const T** columns) const {
  if (!pending_) return 0;
  rows[0] = b_;
  columns[0] = wb_;
  return 1;
}

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::pending_done() {
  for (int i = 1; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) this->P_(i, j) += W_(i, j);
  }
  W_.setZero();
  pending_ = false;
}

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::add_pending_now() {
  begin_update();
  this->flush(0);
}

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::hash_pending(Hash64& hash) const {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) hash.add(W_(i, j));
  }
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

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::rows_with_vehicle(int, typename World::LandmarkRows& rows) const {
  for (int i = 0; i < 2; ++i) rows.add(i, kPositionState + i, T(1));
}

/// xi = p - R(e) p^ of a point that does not turn with the error of the heading: -J p^ e.
CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::rows_in_world(int slot, typename World::LandmarkRows& rows) const {
  rows.add(0, 0, this->p_[slot][1]);
  rows.add(1, 0, -this->p_[slot][0]);
}

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::relative_of(int slot, const T* v, T* out) const {
  const T* l = v + Base::state_of(slot);
  out[0] = l[0] - v[1];
  out[1] = l[1] - v[2];
  if constexpr (LandmarkDim > 2) out[2] = l[2];
}

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::relative_covariance(int slot, detail::RelativeCovariance<T>& out) const {
  const auto& P = this->P_;
  const int l = Base::state_of(slot);
  const T* x = P.row(l);
  const T* y = P.row(l + 1);
  out.s[0] = x[l] - T(2) * x[1] + P.row(1)[1];
  out.s[1] = y[l] - y[1] - x[2] + P.row(2)[1];
  out.s[2] = y[l + 1] - T(2) * y[2] + P.row(2)[2];
  if constexpr (LandmarkDim > 2) {
    const T* height = P.row(l + 2);
    out.s[3] = height[l] - height[1];
    out.s[4] = height[l + 1] - height[2];
    out.s[5] = height[l + 2];
  }
  if (!pending_) return;
  // C B = [-J p, -I].
  const T b[2] = {this->p_[slot][1], -this->p_[slot][0]};
  out.s[0] += b[0] * (b[0] * W_(0, 0) - T(2) * W_(1, 0)) + W_(1, 1);
  out.s[1] += b[0] * b[1] * W_(0, 0) - b[1] * W_(1, 0) - b[0] * W_(2, 0) + W_(2, 1);
  out.s[2] += b[1] * (b[1] * W_(0, 0) - T(2) * W_(2, 0)) + W_(2, 2);
}

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::relative_columns(int slot, T* c0, T* c1, T* c2) const {
  const auto& P = this->P_;
  const int n = P.size();
  const int l = Base::state_of(slot);
  const T* x = P.row(l);
  const T* y = P.row(l + 1);
  for (int j = 0; j < 3; ++j) {
    c0[j] = x[j] - P(j, 1);
    c1[j] = y[j] - P(j, 2);
  }
  const T* row = P.row(3);
  for (int j = 3; j < l; ++j) {
    c0[j] = x[j] - row[1];
    c1[j] = y[j] - row[2];
    row += j + 1;
  }
  c0[l] = row[l] - row[1];
  c1[l] = y[l] - row[2];
  row += l + 1;
  for (int j = l + 1; j < n; ++j) {
    c0[j] = row[l] - row[1];
    c1[j] = row[l + 1] - row[2];
    row += j + 1;
  }
  if constexpr (LandmarkDim > 2) {
    if (c2 != nullptr) {
      const T* height = P.row(l + 2);
      for (int j = 0; j < l + 2; ++j) c2[j] = height[j];
      for (int j = l + 2; j < n; ++j) c2[j] = P.row(j)[l + 2];
    }
  }
}

/// The pending noise's share of two columns: B W (H B)^T, H B = h [-J p, -I]. The rows of the
/// vehicle go into g at once; those of the landmarks are the multiple -f of e = b_. Adds its share
/// to S.
CAIRN_GROUP_TEMPLATE
bool CAIRN_GROUP::pending_column(const typename Base::Pair& pair, T* g0, T* g1, const T** e, T& f0,
                                 T& f1, T& s00, T& s01, T& s11) const {
  if (!pending_) return false;
  const T* p = this->p_[pair.slot];
  // Rows of H B.
  T hb[2][3];
  for (int r = 0; r < 2; ++r) {
    const T hx = pair.direct ? T(r == 0 ? 1 : 0) : pair.h[r][0];
    const T hy = pair.direct ? T(r == 0 ? 0 : 1) : pair.h[r][1];
    hb[r][0] = hx * p[1] - hy * p[0];
    hb[r][1] = -hx;
    hb[r][2] = -hy;
  }
  T m[2][3];
  for (int r = 0; r < 2; ++r) {
    for (int k = 0; k < 3; ++k) {
      m[r][k] = W_(k, 0) * hb[r][0] + W_(k, 1) * hb[r][1] + W_(k, 2) * hb[r][2];
    }
  }
  // b_ is (1, 0, 0) on the vehicle, so its heading row comes with e.
  for (int k = 1; k < 3; ++k) {
    g0[k] += m[0][k];
    g1[k] += m[1][k];
  }
  *e = b_;
  f0 = -m[0][0];
  f1 = -m[1][0];
  for (int k = 0; k < 3; ++k) {
    s00 += hb[0][k] * m[0][k];
    s01 += hb[0][k] * m[1][k];
    s11 += hb[1][k] * m[1][k];
  }
  return true;
}

CAIRN_GROUP_TEMPLATE
typename CAIRN_GROUP::Trial CAIRN_GROUP::begin_trial(const T* d) const {
  // V(t) of the exponential: sin t / t and (1 - cos t) / t = sin^2(t/2) / (t/2).
  Trial trial;
  const T t = clamp(d[0], -kPi<T>, kPi<T>);
  T sine = T(0);
  T cosine = T(1);
  if (abs(t) < T(1e-4)) {
    trial.v00 = T(1) - t * t / T(6);
    trial.v01 = T(0.5) * t;
    return trial;
  }
  sin_cos(T(0.5) * t, sine, cosine);
  trial.v00 = T(2) * sine * cosine / t;
  trial.v01 = T(2) * sine * sine / t;
  return trial;
}

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::relative_after(int slot, const T* d, const Trial& trial, T* out) const {
  // R(t)^T V(t) = V(t)^T.
  const T* l = d + Base::state_of(slot);
  const T x = l[0] - d[1];
  const T y = l[1] - d[2];
  out[0] = this->p_[slot][0] - this->x_[0] + trial.v00 * x + trial.v01 * y;
  out[1] = this->p_[slot][1] - this->x_[1] + trial.v00 * y - trial.v01 * x;
  if constexpr (LandmarkDim > 2) out[2] = this->p_[slot][2] + l[2];
}

/// p <- R(t) p + V(t) xi = p + V(t) (xi + t J p).
CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::correct(const T* d) {
  const T t = clamp(d[0], -kPi<T>, kPi<T>);
  const Trial v = begin_trial(d);
  const auto move = [&](T* p, const T* xi) {
    const T x = xi[0] - t * p[1];
    const T y = xi[1] + t * p[0];
    p[0] += v.v00 * x - v.v01 * y;
    p[1] += v.v01 * x + v.v00 * y;
  };
  this->heading_ = wrap_angle(this->heading_ + t);
  move(this->x_, d + 1);
  const int count = this->table_.size();
  const T* l = d + Base::state_of(0);
  for (int slot = 0; slot < count; ++slot) {
    move(this->p_[slot], l);
    if constexpr (LandmarkDim > 2) this->p_[slot][2] += l[2];
    l += LandmarkDim;
  }
}

#undef CAIRN_GROUP_TEMPLATE
#undef CAIRN_GROUP

}  // namespace cairn
