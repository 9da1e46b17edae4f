#pragma once

#include "cairn/planar/detail/deferred_noise.hpp"
#include "cairn/planar/error_model/cartesian_map.hpp"
#include "cairn/planar/error_model/group_action.hpp"
#include "cairn/planar/error_model/landmark_insertion.hpp"
#include "cairn/planar/increment.hpp"

namespace cairn {

/// Error model of the right-invariant EKF: (e, xi_x, xi_i) in this order, e the error of the
/// heading, xi = x - R(e) x^ for the vehicle and each landmark. The relative vector in the world's
/// axes has the Jacobian C = [0, -I, +I] whatever the heading is, so that no information enters the
/// directions that nothing measures; the transition is the identity.
///
/// Odometry noise is gathered in the 3x3 matrix W, exactly and in O(1). What the vehicle's pose was
/// unsure by when the first landmark came is an error of the whole world: no sighting depends on
/// it, so it stays in the 3x3 matrix G, and P resolves what is small beside it. The covariance is P
/// + B W B^T + U G U^T, B = [I3; -J p_i, 0], U = [I3; 0, I], J = [0 -1; 1 0]. Interface:
/// PlanarSlam.
template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates = LandmarkDim == 3 ? 2 : 0,
          int TravelStates = detail::travel_states(MaxLandmarks, LandmarkDim)>
class GroupErrorModel
    : public detail::CartesianMap<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates> {
  using Map = detail::CartesianMap<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>;
  using Rows = detail::ErrorRows<T, LandmarkDim>;
  using Map::heading_;
  using Map::P_;
  using Map::p_;
  using Map::x_;

 public:
  using typename Map::LandmarkMatrix;
  using typename Map::LandmarkVector;
  static constexpr int kPositionState = 1;
  static constexpr int kHeadingState = 0;
  static constexpr bool kDefersNoise = true;
  static constexpr bool kTurnsAboutAnchor = true;

  void start(const PlanarPose<T>& pose, const Matrix3<T>& covariance);

  /// Pose and landmarks are the exact moments of the Gaussian error (paper A's idea of reading the
  /// lifted state out), in a frame anchored at the first estimate.
  PlanarPose<T> pose() const;
  Matrix3<T> pose_covariance() const { return pose_moments(own_pose_error() + G_); }
  /// Of the pose beside what it shares with all landmarks.
  Matrix3<T> own_pose_covariance() const { return pose_moments(own_pose_error()); }
  LandmarkVector landmark_position(int slot) const;
  LandmarkMatrix landmark_covariance(int slot) const;
  T error_covariance(int i, int j) const {
    return P_(i, j) + deferred_covariance(i, j) + shared_covariance(i, j);
  }
  void hash_deferred(Hash64& hash) const {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) hash.add(W_(i, j));
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j) hash.add(G_(i, j));
    }
  }

  Matrix3<T> waiting_noise() const { return W_; }
  void set_waiting_noise(const Matrix3<T>& noise) {
    W_ = noise;
    deferred_ = true;
  }
  /// The pose is known otherwise to these variances: odometry's noise is no more than that.
  void bound_waiting_noise(T position_variance, T heading_variance) {
    const T position = W_(1, 1) > W_(2, 2) ? W_(1, 1) : W_(2, 2);
    const T heading = W_(0, 0);
    W_.setZero();
    widen_pose(position < position_variance ? position : position_variance,
               heading < heading_variance ? heading : heading_variance);
  }

  void propagate(const PlanarIncrement<T>& increment);
  void widen_pose(T position_variance, T heading_variance);
  void slip_laterally(T variance);
  /// Whether the heading is so unsure that the vehicle's place, turned about the anchor by an error
  /// of it, lies 5 cm beside the line that the linear error allows.
  bool bends() const {
    constexpr T kMost_m = T(0.1);
    constexpr T kNear_m = T(1);
    const T squared = square(x_[0]) + square(x_[1]);
    return squared > square(kNear_m) && square(heading_variance()) * squared > square(kMost_m);
  }
  /// Moves the anchor to the vehicle, about which an error of the heading turns it from now on: xi
  /// becomes xi + J x^ e, exactly what a far anchor takes away. Cost: n (n + 1) multiply-adds.
  void move_anchor();
  detail::DeferredNoise<T> deferred_noise();
  void deferred_noise_absorbed() {
    W_.setZero();
    deferred_ = false;
  }

  void relative_of(int slot, const T* v, T* out) const {
    const T* l = v + Map::state_of(slot);
    out[0] = l[0] - v[1];
    out[1] = l[1] - v[2];
    if constexpr (LandmarkDim > 2) out[2] = l[2];
  }
  void relative_covariance(int slot, RelativeCovariance<T>& out) const;
  using Map::tilt_covariance;
  void tilt_covariance(int slot, TiltCovariance<T>& out) const {
    this->own_tilt_covariance(out);
    const int l = Map::state_of(slot);
    for (int k = 0; k < 2; ++k) {
      const int t = Map::kTiltState + k;
      out.with_relative[k][0] = P_(l, t) - P_(t, 1);
      out.with_relative[k][1] = P_(l + 1, t) - P_(t, 2);
      out.with_relative[k][2] = P_(l + 2, t);
    }
  }
  /// Variances whose difference the relative covariance is, per coordinate.
  void relative_scale(int slot, T* out) const {
    const int l = Map::state_of(slot);
    for (int i = 0; i < LandmarkDim; ++i) out[i] = P_(l + i, l + i);
    for (int i = 0; i < 2; ++i) out[i] += P_(kPositionState + i, kPositionState + i);
  }
  void relative_columns(int slot, T* __restrict c0, T* __restrict c1) const;

  using Retraction = detail::PlanarExponential<T>;
  Retraction retraction(const T* d) const { return Retraction(d[0]); }
  void relative_after(int slot, const T* d, const Retraction& v, T* out) const {
    // R(t)^T V(t) = V(t)^T.
    const T* l = d + Map::state_of(slot);
    const T x = l[0] - d[1];
    const T y = l[1] - d[2];
    out[0] = p_[slot][0] - x_[0] + v.v00 * x + v.v01 * y;
    out[1] = p_[slot][1] - x_[1] + v.v00 * y - v.v01 * x;
    if constexpr (LandmarkDim > 2) out[2] = p_[slot][2] + l[2];
  }
  void correct(const T* d) {
    const Retraction v(d[0]);
    heading_ = wrap_angle(heading_ + v.angle);
    v.template move<2>(x_, d + kPositionState, 1);
    v.template move<LandmarkDim>(p_[0], d + Map::state_of(0), this->landmark_count());
    this->correct_tilt(d);
    this->correct_travel(d);
  }

  void append_landmark(const LandmarkVector& y, const LandmarkMatrix& R) {
    if (this->landmark_count() == 0) share_pose_error();
    detail::append_seen(*this, y, R);
  }
  void append_position() { append_landmark(LandmarkVector::Zero(), LandmarkMatrix::Zero()); }
  void append_landmark_on_path(const LandmarkVector& y, const LandmarkMatrix& R, int past,
                               const Matrix<T, LandmarkDim, 2>& by_path) {
    detail::append_seen_on_path(*this, y, R, past, by_path);
  }
  void rows_beside_vehicle(int, Rows& rows) const {
    for (int i = 0; i < 2; ++i) rows.add(i, kPositionState + i, T(1));
  }
  /// What is known in the world does not share the world's error: G enters P before it comes.
  void join_world();
  /// Vehicle and landmarks move together by an offset of `position_variance` per axis, and turn
  /// about the vehicle by `heading_variance`: no sighting shows it. Cost: O(1).
  void drift_world(T position_variance, T heading_variance) {
    widen(G_, position_variance, heading_variance);
  }
  /// xi = p - R(e) p^ of a point that does not turn with the error of the heading: -J p^ e.
  void rows_in_world(int slot, Rows& rows, T weight) const {
    rows.add(0, kHeadingState, weight * p_[slot][1]);
    rows.add(1, kHeadingState, -(weight * p_[slot][0]));
  }

 private:
  void travel_beside(T distance_m, const RelativeFrame<T>& frame, Displacement<T>& u);
  /// Column of U that has a 1 in row `state`, -1 where there is none.
  int shared_axis(int state) const {
    if (state < 3) return state;
    if (state < Map::vehicle_states()) return -1;
    const int axis = (state - Map::vehicle_states()) % LandmarkDim;
    return axis < 2 ? 1 + axis : -1;
  }
  Matrix3<T> own_pose_error() const;
  Matrix3<T> pose_moments(const Matrix3<T>& error) const;
  T heading_variance() const { return P_(0, 0) + W_(0, 0) + G_(0, 0); }
  T deferred_covariance(int i, int j) const;
  T shared_covariance(int i, int j) const {
    const int a = shared_axis(i);
    const int b = shared_axis(j);
    return a < 0 || b < 0 ? T(0) : G_(a, b);
  }
  void share_pose_error();
  /// An offset, and a turn about the vehicle, of what `m` is the covariance of.
  void widen(Matrix3<T>& m, T position_variance, T heading_variance) const {
    const T g[3] = {T(1), x_[1], -x_[0]};
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) m(i, j) += g[i] * heading_variance * g[j];
    }
    m(1, 1) += position_variance;
    m(2, 2) += position_variance;
  }

  Matrix3<T> W_ = Matrix3<T>::Zero();  ///< odometry noise since the last pass over P
  bool deferred_ = false;              ///< W was added to
  Matrix3<T> G_ = Matrix3<T>::Zero();  ///< error of the world that all states share
  T along_[Map::kStates] = {};         ///< of deferred_noise()
};

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::start(
    const PlanarPose<T>& pose, const Matrix3<T>& covariance) {
  // Anchored at the estimate, x^ = 0 and xi_x is the plain position error.
  this->start_at(pose, true);
  const int from[3] = {2, 0, 1};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j <= i; ++j) P_(i, j) = covariance(from[i], from[j]);
  }
  deferred_noise_absorbed();
  G_.setZero();
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::propagate(
    const PlanarIncrement<T>& increment) {
  const RelativeFrame<T> f = this->frame();
  Displacement<T> u = displacement(increment);
  if (this->travels()) travel_beside(increment.distance_m, f, u);
  T step[2];
  T by_distance[2];
  T by_turn[2];
  f.to_relative(u.u.data(), step);
  f.to_relative(u.by_distance.data(), by_distance);
  f.to_relative(u.by_turn.data(), by_turn);
  x_[0] += step[0];
  x_[1] += step[1];
  heading_ = wrap_angle(heading_ + increment.turn_rad);

  // W += g Q g^T with g = [0 1; R u_d, R u_a - J x'].
  const T g[3][2] = {
      {T(0), T(1)}, {by_distance[0], by_turn[0] + x_[1]}, {by_distance[1], by_turn[1] - x_[0]}};
  const Matrix2<T>& q = increment.covariance;
  for (int i = 0; i < 3; ++i) {
    const T gq0 = g[i][0] * q(0, 0) + g[i][1] * q(1, 0);
    const T gq1 = g[i][0] * q(0, 1) + g[i][1] * q(1, 1);
    for (int j = 0; j <= i; ++j) W_(i, j) += gq0 * g[j][0] + gq1 * g[j][1];
  }
  W_(0, 1) = W_(1, 0);
  W_(0, 2) = W_(2, 0);
  W_(1, 2) = W_(2, 1);
  deferred_ = true;
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::widen_pose(
    T position_variance, T heading_variance) {
  widen(W_, position_variance, heading_variance);
  deferred_ = true;
}

/// W = b b^T + [0, 0; 0, rest] with b = W e_0 / sqrt(W_00); the result holds B b and rest.
template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
detail::DeferredNoise<T>
GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::deferred_noise() {
  detail::DeferredNoise<T> noise;
  if (!deferred_) return noise;
  const T root = sqrt(W_(0, 0));
  const T inverse = root > T(0) ? T(1) / root : T(0);
  along_[0] = root;
  along_[1] = W_(0, 1) * inverse;
  along_[2] = W_(0, 2) * inverse;
  const int count = this->landmark_count();
  for (int i = 3; i < Map::vehicle_states(); ++i) along_[i] = T(0);
  T* b = along_ + Map::state_of(0);
  for (int slot = 0; slot < count; ++slot) {
    b[0] = root * p_[slot][1];
    b[1] = -root * p_[slot][0];
    if constexpr (LandmarkDim > 2) b[2] = T(0);
    b += LandmarkDim;
  }
  noise.along = along_;
  noise.rest[0] = W_(1, 1) - along_[1] * along_[1];
  noise.rest[1] = W_(2, 1) - along_[2] * along_[1];
  noise.rest[2] = W_(2, 2) - along_[2] * along_[2];
  return noise;
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::relative_covariance(
    int slot, RelativeCovariance<T>& out) const {
  const int l = Map::state_of(slot);
  const T* x = P_.row(l);
  const T* y = P_.row(l + 1);
  out.s[0] = x[l] - T(2) * x[1] + P_.row(1)[1];
  out.s[1] = y[l] - y[1] - x[2] + P_.row(2)[1];
  out.s[2] = y[l + 1] - T(2) * y[2] + P_.row(2)[2];
  if constexpr (LandmarkDim > 2) {
    const T* height = P_.row(l + 2);
    out.s[3] = height[l] - height[1];
    out.s[4] = height[l + 1] - height[2];
    out.s[5] = height[l + 2];
  }
  if (!deferred_) return;
  // C B = [-J p, -I].
  const T b[2] = {p_[slot][1], -p_[slot][0]};
  out.s[0] += b[0] * (b[0] * W_(0, 0) - T(2) * W_(1, 0)) + W_(1, 1);
  out.s[1] += b[0] * b[1] * W_(0, 0) - b[1] * W_(1, 0) - b[0] * W_(2, 0) + W_(2, 1);
  out.s[2] += b[1] * (b[1] * W_(0, 0) - T(2) * W_(2, 0)) + W_(2, 2);
}

template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates>
void GroupErrorModel<T, MaxLandmarks, LandmarkDim, TiltStates, TravelStates>::relative_columns(
    int slot, T* __restrict c0, T* __restrict c1) const {
  const int n = P_.size();
  const int l = Map::state_of(slot);
  const T* x = P_.row(l);
  const T* y = P_.row(l + 1);
  for (int k = 0; k < 3; ++k) {
    c0[k] = x[k] - P_(k, 1);
    c1[k] = y[k] - P_(k, 2);
  }
  // Element 1 of row j, for the landmarks' rows two at a time: row j has j + 1 elements.
  const T* p = P_.row(3) + 1;
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
}

}  // namespace cairn

#include "cairn/planar/error_model/group_anchor.hpp"
#include "cairn/planar/error_model/group_read_out.hpp"
