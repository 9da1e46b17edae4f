#pragma once

#include "cairn/planar/error_model/cartesian_map.hpp"
#include "cairn/planar/error_model/landmark_insertion.hpp"
#include "cairn/planar/increment.hpp"

namespace cairn {

/// Error model of the plain EKF: the differences of x, y, heading and landmarks, in this order, in
/// the world's axes. With delta = p - x and J = [0 -1; 1 0], the relative vector in the world's
/// axes has the Jacobian C = [-I, -J delta, +I]: a sighting is taken to say something about the
/// heading. Interface: PlanarSlam.
template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates = LandmarkDim == 3 ? 2 : 0>
class WorldErrorModel : public detail::CartesianMap<T, MaxLandmarks, LandmarkDim, TiltStates> {
  using Map = detail::CartesianMap<T, MaxLandmarks, LandmarkDim, TiltStates>;
  using Rows = detail::ErrorRows<T, LandmarkDim>;
  using Map::heading_;
  using Map::P_;
  using Map::p_;
  using Map::x_;

 public:
  using typename Map::LandmarkMatrix;
  using typename Map::LandmarkVector;
  static constexpr int kPositionState = 0;
  static constexpr int kHeadingState = 2;
  static constexpr bool kDefersNoise = false;
  static constexpr bool kTurnsAboutAnchor = false;

  void start(const PlanarPose<T>& pose, const Matrix3<T>& covariance) {
    this->start_at(pose, false);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) P_(i, j) = covariance(i, j);
    }
  }

  PlanarPose<T> pose() const { return this->mean_pose(); }
  Matrix3<T> pose_covariance() const {
    Matrix3<T> c;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) c(i, j) = P_(i, j);
    }
    return c;
  }
  LandmarkVector landmark_position(int slot) const { return this->mean_landmark(slot); }
  LandmarkMatrix landmark_covariance(int slot) const {
    LandmarkMatrix c;
    const int first = Map::state_of(slot);
    for (int i = 0; i < LandmarkDim; ++i) {
      for (int j = 0; j < LandmarkDim; ++j) c(i, j) = P_(first + i, first + j);
    }
    return c;
  }
  T error_covariance(int i, int j) const { return P_(i, j); }

  void propagate(const PlanarIncrement<T>& increment);
  void widen_pose(T position_variance, T heading_variance) {
    P_(0, 0) += position_variance;
    P_(1, 1) += position_variance;
    P_(2, 2) += heading_variance;
  }
  void slip_laterally(T variance) {
    const RelativeFrame<T> f = this->frame();
    P_(0, 0) += variance * square(f.sine);
    P_(1, 0) -= variance * f.sine * f.cosine;
    P_(1, 1) += variance * square(f.cosine);
  }

  void relative_of(int slot, const T* v, T* out) const {
    const T* l = v + Map::state_of(slot);
    const T dx = p_[slot][0] - x_[0];
    const T dy = p_[slot][1] - x_[1];
    out[0] = l[0] - v[0] + dy * v[2];
    out[1] = l[1] - v[1] - dx * v[2];
    if constexpr (LandmarkDim > 2) out[2] = l[2];
  }
  void relative_covariance(int slot, RelativeCovariance<T>& out) const;
  using Map::tilt_covariance;
  void tilt_covariance(int slot, TiltCovariance<T>& out) const {
    this->own_tilt_covariance(out);
    const int l = Map::state_of(slot);
    const T dx = p_[slot][0] - x_[0];
    const T dy = p_[slot][1] - x_[1];
    for (int k = 0; k < 2; ++k) {
      const int t = Map::kTiltState + k;
      out.with_relative[k][0] = P_(l, t) - P_(t, 0) + dy * P_(t, 2);
      out.with_relative[k][1] = P_(l + 1, t) - P_(t, 1) - dx * P_(t, 2);
      out.with_relative[k][2] = P_(l + 2, t);
    }
  }
  /// Variances whose difference the relative covariance is, per coordinate.
  void relative_scale(int slot, T* out) const {
    const int l = Map::state_of(slot);
    const T arm[2] = {p_[slot][1] - x_[1], p_[slot][0] - x_[0]};
    for (int i = 0; i < LandmarkDim; ++i) out[i] = P_(l + i, l + i);
    for (int i = 0; i < 2; ++i)
      out[i] += P_(i, i) + square(arm[i]) * P_(kHeadingState, kHeadingState);
  }
  void relative_columns(int slot, T* c0, T* c1) const;

  struct Retraction {
    T cosine;
    T sine;
  };
  Retraction retraction(const T* d) const {
    Retraction r;
    sin_cos(d[2], r.sine, r.cosine);
    return r;
  }
  void relative_after(int slot, const T* d, const Retraction& r, T* out) const {
    const T* l = d + Map::state_of(slot);
    const T dx = p_[slot][0] - x_[0] + l[0] - d[0];
    const T dy = p_[slot][1] - x_[1] + l[1] - d[1];
    out[0] = r.cosine * dx + r.sine * dy;
    out[1] = r.cosine * dy - r.sine * dx;
    if constexpr (LandmarkDim > 2) out[2] = p_[slot][2] + l[2];
  }
  void correct(const T* d) {
    x_[0] += d[0];
    x_[1] += d[1];
    heading_ = wrap_angle(heading_ + clamp(d[2], -kPi<T>, kPi<T>));
    const int count = this->landmark_count();
    for (int slot = 0; slot < count; ++slot) {
      const T* l = d + Map::state_of(slot);
      for (int i = 0; i < LandmarkDim; ++i) p_[slot][i] += l[i];
    }
    this->correct_tilt(d);
  }

  void append_landmark(const LandmarkVector& y, const LandmarkMatrix& R) {
    detail::append_seen(*this, y, R);
  }
  void append_position() { append_landmark(LandmarkVector::Zero(), LandmarkMatrix::Zero()); }
  void append_landmark_on_path(const LandmarkVector& y, const LandmarkMatrix& R, int past,
                               const Matrix<T, LandmarkDim, 2>& by_path) {
    detail::append_seen_on_path(*this, y, R, past, by_path);
  }
  /// d p / d heading = J delta.
  void rows_beside_vehicle(int slot, Rows& rows) const {
    for (int i = 0; i < 2; ++i) rows.add(i, kPositionState + i, T(1));
    rows.add(0, kHeadingState, x_[1] - p_[slot][1]);
    rows.add(1, kHeadingState, p_[slot][0] - x_[0]);
  }
  void join_world() {}
  void rows_in_world(int, Rows&, T) const {}
};

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates>
void WorldErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates>::propagate(
    const PlanarIncrement<T>& increment) {
  const RelativeFrame<T> f = this->frame();
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
  const T tt = P_(2, 2);
  const T xt = P_(2, 0);
  const T yt = P_(2, 1);
  P_(0, 0) += a * (T(2) * xt + a * tt);
  P_(1, 0) += a * yt + b * xt + a * b * tt;
  P_(1, 1) += b * (T(2) * yt + b * tt);
  P_(2, 0) += a * tt;
  P_(2, 1) += b * tt;
  const int n = P_.size();
  T* row = P_.row(3);
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
    for (int j = 0; j <= i; ++j) P_(i, j) += gq0 * g[j][0] + gq1 * g[j][1];
  }
  x_[0] += step[0];
  x_[1] += step[1];
  heading_ = wrap_angle(heading_ + increment.turn_rad);
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates>
void WorldErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates>::relative_covariance(
    int slot, RelativeCovariance<T>& out) const {
  const int l = Map::state_of(slot);
  const T dx = p_[slot][0] - x_[0];
  const T dy = p_[slot][1] - x_[1];
  const T* x = P_.row(l);
  const T* y = P_.row(l + 1);
  const T* p0 = P_.row(0);
  const T* p1 = P_.row(1);
  const T* p2 = P_.row(2);
  // P C^T at the vehicle, then C on the other side.
  const T c0[3] = {x[0] - p0[0] + dy * p2[0], x[1] - p1[0] + dy * p2[1], x[2] - p2[0] + dy * p2[2]};
  const T c1[3] = {y[0] - p1[0] - dx * p2[0], y[1] - p1[1] - dx * p2[1], y[2] - p2[1] - dx * p2[2]};
  out.s[0] = x[l] - x[0] + dy * x[2] - c0[0] + dy * c0[2];
  out.s[1] = y[l] - y[0] + dy * y[2] - c0[1] - dx * c0[2];
  out.s[2] = y[l + 1] - y[1] - dx * y[2] - c1[1] - dx * c1[2];
  if constexpr (LandmarkDim > 2) {
    const T* height = P_.row(l + 2);
    out.s[3] = height[l] - height[0] + dy * height[2];
    out.s[4] = height[l + 1] - height[1] - dx * height[2];
    out.s[5] = height[l + 2];
  }
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates>
void WorldErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates>::relative_columns(int slot, T* c0,
                                                                                 T* c1) const {
  const int n = P_.size();
  const int l = Map::state_of(slot);
  const T dx = p_[slot][0] - x_[0];
  const T dy = p_[slot][1] - x_[1];
  const T* x = P_.row(l);
  const T* y = P_.row(l + 1);
  for (int j = 0; j < 3; ++j) {
    c0[j] = x[j] - P_(j, 0) + dy * P_(j, 2);
    c1[j] = y[j] - P_(j, 1) - dx * P_(j, 2);
  }
  const T* row = P_.row(3);
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
}

}  // namespace cairn
