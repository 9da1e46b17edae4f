#pragma once

namespace cairn {

// Error order: 0 e (heading), 1, 2 xi_x, then xi_i. J = [0 -1; 1 0]. P + B W B^T is the covariance,
// B = [I3; -J p_i, 0]; W gathers g Q g^T with g = [0 1; R u_d, R u_a - J x']. Rows of the relative
// vector in the world's axes: C = [0, -I, +I].

namespace detail {

/// p += V (xi + t J p) for `count` points of `Dim` coordinates; a height moves by its own.
template <int Dim, class T>
inline void move_points(T* __restrict p, const T* __restrict xi, int count, T t, T v00, T v01) {
  // V t J = R(t) - 1, as rows of factors: the two coordinates go through the same operations.
  const T turn = t * v00;
  const T same = -t * v01;
  const T crossed[2] = {-turn, turn};
  const T across[2] = {-v01, v01};
  for (int k = 0; k < count; ++k) {
    const T swapped_p[2] = {p[1], p[0]};
    const T swapped_xi[2] = {xi[1], xi[0]};
    for (int i = 0; i < 2; ++i) {
      p[i] += same * p[i] + crossed[i] * swapped_p[i] + v00 * xi[i] + across[i] * swapped_xi[i];
    }
    if constexpr (Dim > 2) p[2] += xi[2];
    p += Dim;
    xi += Dim;
  }
}

}  // namespace detail

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
  const T root = sqrt(W_(0, 0));
  const T inverse = root > T(0) ? T(1) / root : T(0);
  b_[0] = root;
  b_[1] = W_(0, 1) * inverse;
  b_[2] = W_(0, 2) * inverse;
  rest_[0] = W_(1, 1) - b_[1] * b_[1];
  rest_[1] = W_(2, 1) - b_[2] * b_[1];
  rest_[2] = W_(2, 2) - b_[2] * b_[2];
  const int count = this->table_.size();
  T* b = b_ + Base::state_of(0);
  for (int slot = 0; slot < count; ++slot) {
    b[0] = root * this->p_[slot][1];
    b[1] = -root * this->p_[slot][0];
    if constexpr (LandmarkDim > 2) b[2] = T(0);
    b += LandmarkDim;
  }
}

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::pending_done() {
  this->P_(1, 1) += rest_[0];
  this->P_(2, 1) += rest_[1];
  this->P_(2, 2) += rest_[2];
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

CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::rows_with_vehicle(int, typename World::LandmarkRows& rows) const {
  for (int i = 0; i < 2; ++i) rows.add(i, kPositionState + i, T(1));
}

/// xi = p - R(e) p^ of a point that does not turn with the error of the heading: -J p^ e.
CAIRN_GROUP_TEMPLATE
void CAIRN_GROUP::rows_in_world(int slot, typename World::LandmarkRows& rows, T weight) const {
  rows.add(0, 0, weight * this->p_[slot][1]);
  rows.add(1, 0, -(weight * this->p_[slot][0]));
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
void CAIRN_GROUP::relative_columns(int slot, T* __restrict c0, T* __restrict c1,
                                   T* __restrict c2) const {
  const auto& P = this->P_;
  const int n = P.size();
  const int l = Base::state_of(slot);
  const T* x = P.row(l);
  const T* y = P.row(l + 1);
  for (int k = 0; k < 3; ++k) {
    c0[k] = x[k] - P(k, 1);
    c1[k] = y[k] - P(k, 2);
  }
  // Element 1 of row j, for the landmarks' rows two at a time: row j has j + 1 elements.
  const T* p = P.row(3) + 1;
  int j = 3;
  for (; j + 1 < l; j += 2) {
    c0[j] = x[j] - p[0];
    c1[j] = y[j] - p[1];
    p += j + 1;
    c0[j + 1] = x[j + 1] - p[0];
    c1[j + 1] = y[j + 1] - p[1];
    p += j + 2;
  }
  for (; j <= l; ++j) {
    c0[j] = x[j] - p[0];
    c1[j] = y[j] - p[1];
    p += j + 1;
  }
  const int to = l - 1;
  for (int pairs = (n - j) / 2; pairs > 0; --pairs) {
    c0[j] = p[to] - p[0];
    c1[j] = p[to + 1] - p[1];
    p += j + 1;
    c0[j + 1] = p[to] - p[0];
    c1[j + 1] = p[to + 1] - p[1];
    p += j + 2;
    j += 2;
  }
  if (j < n) {
    c0[j] = p[to] - p[0];
    c1[j] = p[to + 1] - p[1];
  }
  if constexpr (LandmarkDim > 2) {
    if (c2 != nullptr) {
      const T* height = P.row(l + 2);
      for (int k = 0; k < l + 2; ++k) c2[k] = height[k];
      for (int k = l + 2; k < n; ++k) c2[k] = P.row(k)[l + 2];
    }
  }
}

/// The pending noise's share of two columns, B W (H B)^T with H B = h [-J p, -I], and of S: the
/// multiple -f of b_, the result, and on the position what `rest_` gives, which goes into g at
/// once.
CAIRN_GROUP_TEMPLATE
const T* CAIRN_GROUP::pending_column(const typename Base::Pair& pair, T* g0, T* g1, T& f0, T& f1,
                                     T& s00, T& s01, T& s11) const {
  if (!pending_) return nullptr;
  T along[LandmarkDim];
  relative_of(pair.slot, b_, along);
  f0 = -pair.row(0, along);
  f1 = -pair.row(1, along);
  s00 += f0 * f0;
  s01 += f0 * f1;
  s11 += f1 * f1;
  const T h[2][2] = {{pair.direct ? T(1) : pair.h[0][0], pair.direct ? T(0) : pair.h[0][1]},
                     {pair.direct ? T(0) : pair.h[1][0], pair.direct ? T(1) : pair.h[1][1]}};
  T by_rest[2][2];
  for (int r = 0; r < 2; ++r) {
    by_rest[r][0] = rest_[0] * h[r][0] + rest_[1] * h[r][1];
    by_rest[r][1] = rest_[1] * h[r][0] + rest_[2] * h[r][1];
  }
  for (int k = 0; k < 2; ++k) {
    g0[1 + k] -= by_rest[0][k];
    g1[1 + k] -= by_rest[1][k];
    s00 += h[0][k] * by_rest[0][k];
    s01 += h[0][k] * by_rest[1][k];
    s11 += h[1][k] * by_rest[1][k];
  }
  return b_;
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
  this->heading_ = wrap_angle(this->heading_ + t);
  detail::move_points<2>(this->x_, d + 1, 1, t, v.v00, v.v01);
  detail::move_points<LandmarkDim>(this->p_[0], d + Base::state_of(0), this->table_.size(), t,
                                   v.v00, v.v01);
}

}  // namespace cairn
