#pragma once

namespace cairn {

// State order: 0 x, 1 y, 2 heading, then the landmarks. delta = p - x, J = [0 -1; 1 0]:
// relative vector R(t)^T delta, here kept in the world's axes, C = [-I, -J delta, +I].

#define CAIRN_EKF_TEMPLATE template <class T, int MaxLandmarks, int LandmarkDim>
#define CAIRN_EKF EkfSlam<T, MaxLandmarks, LandmarkDim>

CAIRN_EKF_TEMPLATE
Status CAIRN_EKF::initialise(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                             const PlanarParameters<T>& parameters) {
  const Status status = this->begin(pose, covariance, parameters);
  if (!ok(status)) return status;
  this->heading_ = wrap_angle(pose.heading);
  for (int i = 0; i < 2; ++i) {
    this->x_[i] = pose.position(i);
    this->anchor_[i] = T(0);
  }
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) this->P_(i, j) = covariance(i, j);
  }
  return Status::kOk;
}

CAIRN_EKF_TEMPLATE
Matrix3<T> CAIRN_EKF::pose_covariance() const {
  Matrix3<T> c;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) c(i, j) = this->P_(i, j);
  }
  return c;
}

CAIRN_EKF_TEMPLATE
Matrix<T, LandmarkDim, LandmarkDim> CAIRN_EKF::landmark_covariance(int slot) const {
  Matrix<T, LandmarkDim, LandmarkDim> c;
  const int first = Base::state_of(slot);
  for (int i = 0; i < LandmarkDim; ++i) {
    for (int j = 0; j < LandmarkDim; ++j) c(i, j) = this->P_(first + i, first + j);
  }
  return c;
}

CAIRN_EKF_TEMPLATE
void CAIRN_EKF::propagate(const PlanarIncrement<T>& increment) {
  const detail::RelativeFrame<T> f = this->frame();
  const Displacement<T> u = displacement(increment);
  T step[2];
  T by_distance[2];
  T by_turn[2];
  f.to_relative(u.u.data(), step);
  f.to_relative(u.by_distance.data(), by_distance);
  f.to_relative(u.by_turn.data(), by_turn);

  // F = [I, J step; 0, 1] on the vehicle, identity elsewhere.
  const T a = -step[1];
  const T b = step[0];
  auto& P = this->P_;
  const T tt = P(2, 2);
  const T xt = P(2, 0);
  const T yt = P(2, 1);
  P(0, 0) += a * (T(2) * xt + a * tt);
  P(1, 0) += a * yt + b * xt + a * b * tt;
  P(1, 1) += b * (T(2) * yt + b * tt);
  P(2, 0) += a * tt;
  P(2, 1) += b * tt;
  const int n = P.size();
  T* row = P.row(3);
  for (int i = 3; i < n; ++i) {
    row[0] += a * row[2];
    row[1] += b * row[2];
    row += i + 1;
  }

  const T g[3][2] = {{by_distance[0], by_turn[0]}, {by_distance[1], by_turn[1]}, {T(0), T(1)}};
  const Matrix2<T>& q = increment.covariance;
  for (int i = 0; i < 3; ++i) {
    const T gq0 = g[i][0] * q(0, 0) + g[i][1] * q(1, 0);
    const T gq1 = g[i][0] * q(0, 1) + g[i][1] * q(1, 1);
    for (int j = 0; j <= i; ++j) P(i, j) += gq0 * g[j][0] + gq1 * g[j][1];
  }
  this->x_[0] += step[0];
  this->x_[1] += step[1];
  this->heading_ = wrap_angle(this->heading_ + increment.turn_rad);
}

CAIRN_EKF_TEMPLATE
void CAIRN_EKF::widen_pose_by(T position_variance, T heading_variance) {
  this->P_(0, 0) += position_variance;
  this->P_(1, 1) += position_variance;
  this->P_(2, 2) += heading_variance;
}

CAIRN_EKF_TEMPLATE
void CAIRN_EKF::rows_with_vehicle(int slot, typename World::LandmarkRows& rows) const {
  for (int i = 0; i < 2; ++i) rows.add(i, kPositionState + i, T(1));
  // d p / d heading = J delta.
  rows.add(0, 2, this->x_[1] - this->p_[slot][1]);
  rows.add(1, 2, this->p_[slot][0] - this->x_[0]);
}

CAIRN_EKF_TEMPLATE
void CAIRN_EKF::relative_of(int slot, const T* v, T* out) const {
  const T* l = v + Base::state_of(slot);
  const T dx = this->p_[slot][0] - this->x_[0];
  const T dy = this->p_[slot][1] - this->x_[1];
  out[0] = l[0] - v[0] + dy * v[2];
  out[1] = l[1] - v[1] - dx * v[2];
  if constexpr (LandmarkDim > 2) out[2] = l[2];
}

CAIRN_EKF_TEMPLATE
void CAIRN_EKF::relative_covariance(int slot, detail::RelativeCovariance<T>& out) const {
  const int l = Base::state_of(slot);
  const T dx = this->p_[slot][0] - this->x_[0];
  const T dy = this->p_[slot][1] - this->x_[1];
  const auto& P = this->P_;
  const T* x = P.row(l);
  const T* y = P.row(l + 1);
  const T* p0 = P.row(0);
  const T* p1 = P.row(1);
  const T* p2 = P.row(2);
  // P C^T at the vehicle, then C on the other side.
  const T c0[3] = {x[0] - p0[0] + dy * p2[0], x[1] - p1[0] + dy * p2[1], x[2] - p2[0] + dy * p2[2]};
  const T c1[3] = {y[0] - p1[0] - dx * p2[0], y[1] - p1[1] - dx * p2[1], y[2] - p2[1] - dx * p2[2]};
  out.s[0] = x[l] - x[0] + dy * x[2] - c0[0] + dy * c0[2];
  out.s[1] = y[l] - y[0] + dy * y[2] - c0[1] - dx * c0[2];
  out.s[2] = y[l + 1] - y[1] - dx * y[2] - c1[1] - dx * c1[2];
  if constexpr (LandmarkDim > 2) {
    const T* height = P.row(l + 2);
    out.s[3] = height[l] - height[0] + dy * height[2];
    out.s[4] = height[l + 1] - height[1] - dx * height[2];
    out.s[5] = height[l + 2];
  }
}

CAIRN_EKF_TEMPLATE
void CAIRN_EKF::relative_columns(int slot, T* c0, T* c1, T* c2) const {
  const auto& P = this->P_;
  const int n = P.size();
  const int l = Base::state_of(slot);
  const T dx = this->p_[slot][0] - this->x_[0];
  const T dy = this->p_[slot][1] - this->x_[1];
  const T* x = P.row(l);
  const T* y = P.row(l + 1);
  for (int j = 0; j < 3; ++j) {
    c0[j] = x[j] - P(j, 0) + dy * P(j, 2);
    c1[j] = y[j] - P(j, 1) - dx * P(j, 2);
  }
  const T* row = P.row(3);
  for (int j = 3; j < l; ++j) {
    c0[j] = x[j] - row[0] + dy * row[2];
    c1[j] = y[j] - row[1] - dx * row[2];
    row += j + 1;
  }
  c0[l] = row[l] - row[0] + dy * row[2];
  c1[l] = y[l] - row[1] - dx * row[2];
  row += l + 1;
  for (int j = l + 1; j < n; ++j) {
    c0[j] = row[l] - row[0] + dy * row[2];
    c1[j] = row[l + 1] - row[1] - dx * row[2];
    row += j + 1;
  }
  if constexpr (LandmarkDim > 2) {
    if (c2 == nullptr) return;
    const T* height = P.row(l + 2);
    for (int j = 0; j < l + 2; ++j) c2[j] = height[j];
    for (int j = l + 2; j < n; ++j) c2[j] = P.row(j)[l + 2];
  }
}

CAIRN_EKF_TEMPLATE
typename CAIRN_EKF::Trial CAIRN_EKF::begin_trial(const T* d) const {
  Trial trial;
  sin_cos(d[2], trial.sine, trial.cosine);
  return trial;
}

CAIRN_EKF_TEMPLATE
void CAIRN_EKF::relative_after(int slot, const T* d, const Trial& trial, T* out) const {
  const T* l = d + Base::state_of(slot);
  const T dx = this->p_[slot][0] - this->x_[0] + l[0] - d[0];
  const T dy = this->p_[slot][1] - this->x_[1] + l[1] - d[1];
  out[0] = trial.cosine * dx + trial.sine * dy;
  out[1] = trial.cosine * dy - trial.sine * dx;
  if constexpr (LandmarkDim > 2) out[2] = this->p_[slot][2] + l[2];
}

CAIRN_EKF_TEMPLATE
void CAIRN_EKF::correct(const T* d) {
  this->x_[0] += d[0];
  this->x_[1] += d[1];
  this->heading_ = wrap_angle(this->heading_ + clamp(d[2], -kPi<T>, kPi<T>));
  for (int slot = 0; slot < this->table_.size(); ++slot) {
    const T* l = d + Base::state_of(slot);
    for (int i = 0; i < LandmarkDim; ++i) this->p_[slot][i] += l[i];
  }
}

#undef CAIRN_EKF_TEMPLATE
#undef CAIRN_EKF

}  // namespace cairn
