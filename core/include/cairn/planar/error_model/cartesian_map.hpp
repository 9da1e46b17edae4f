#pragma once

#include "cairn/base/hash.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/planar/observation/linearised_observation.hpp"
#include "cairn/planar/tilt.hpp"
#include "cairn/planar/types.hpp"

namespace cairn::detail {

/// Small maps leave the direction of travel out: they are for 64 KB of memory.
constexpr int travel_states(int max_landmarks, int landmark_dim) {
  return landmark_dim == 3 && max_landmarks > 16 ? 1 : 0;
}

/// What the error models have in common whose landmarks are points of the world: the mean, heading,
/// position, tilt and landmarks, and the storage of the covariance, with three states of the pose,
/// two of the tilt where there is one, one of the direction of travel where it is unsure, and as
/// many per landmark as it has coordinates. Positions are kept relative to an anchor.
template <class T, int MaxLandmarks, int LandmarkDim, int TiltStates, int TravelStates = 0>
class CartesianMap {
 public:
  using Scalar = T;
  static constexpr int kMaxLandmarks = MaxLandmarks;
  static constexpr int kLandmarkDim = LandmarkDim;
  static constexpr int kPoseStates = 3;
  static constexpr int kTiltStates = TiltStates;  ///< 2, or 0: without tilt
  static constexpr int kTiltState = kPoseStates;  ///< pitch, then roll
  static constexpr int kVehicleStates = kPoseStates + kTiltStates + TravelStates;  ///< at most
  static constexpr int kLandmarkStates = LandmarkDim;
  static constexpr int kStates = kVehicleStates + MaxLandmarks * kLandmarkStates;
  static constexpr bool kHasWorldLandmarks = true;
  using Covariance = PackedSymmetric<T, kStates>;
  using LandmarkVector = Vector<T, LandmarkDim>;
  using LandmarkMatrix = Matrix<T, LandmarkDim, LandmarkDim>;

  static_assert(TiltStates == 0 || (TiltStates == 2 && LandmarkDim == 3));

  /// States before the first landmark's.
  int vehicle_states() const {
    return TiltStates + TravelStates > 0 ? vehicle_states_ : kPoseStates;
  }
  int state_of(int slot) const { return vehicle_states() + slot * kLandmarkStates; }
  /// Of landmarks with one.
  int height_state(int slot) const { return state_of(slot) + 2; }
  int landmark_count() const { return landmarks_; }
  Covariance& covariance() { return P_; }
  const Covariance& covariance() const { return P_; }

  PlanarPose<T> mean_pose() const {
    PlanarPose<T> pose;
    pose.position = {anchor_[0] + x_[0], anchor_[1] + x_[1]};
    pose.heading = heading_;
    return pose;
  }
  void move_pose(const PlanarPose<T>& pose) {
    x_[0] = pose.position.x() - anchor_[0];
    x_[1] = pose.position.y() - anchor_[1];
    heading_ = pose.heading;
  }
  /// Noise that waits to enter the covariance: none, where there is no such.
  Matrix3<T> waiting_noise() const { return Matrix3<T>::Zero(); }
  void set_waiting_noise(const Matrix3<T>&) {}
  void bound_waiting_noise(T, T) {}
  LandmarkVector mean_landmark(int slot) const {
    LandmarkVector p;
    for (int i = 0; i < LandmarkDim; ++i) p(i) = p_[slot][i];
    p(0) += anchor_[0];
    p(1) += anchor_[1];
    return p;
  }
  /// The same, m, in the model's own coordinates.
  const T* landmark(int slot) const { return p_[slot]; }
  const T* vehicle() const { return x_; }
  const T* anchor() const { return anchor_; }

  RelativeFrame<T> frame() const {
    RelativeFrame<T> f;
    sin_cos(heading_, f.sine, f.cosine);
    return f;
  }
  void relative(int slot, T* out) const {
    out[0] = p_[slot][0] - x_[0];
    out[1] = p_[slot][1] - x_[1];
    if constexpr (LandmarkDim > 2) out[2] = p_[slot][2];
  }

  /// Rotation from the level vehicle's axes to the world's.
  LandmarkMatrix level_axes() const {
    const RelativeFrame<T> f = frame();
    LandmarkMatrix rotation = LandmarkMatrix::Identity();
    rotation(0, 0) = f.cosine;
    rotation(0, 1) = -f.sine;
    rotation(1, 0) = f.sine;
    rotation(1, 1) = f.cosine;
    return rotation;
  }
  /// Rotation from the vehicle's axes, tilted with it, to the world's.
  LandmarkMatrix vehicle_axes() const {
    const LandmarkMatrix level = level_axes();
    if constexpr (TiltStates > 0) {
      if (tilts_) return level * tilt_.R_level_vehicle().toRotationMatrix();
    }
    return level;
  }

  bool tilts() const { return TiltStates > 0 && tilts_; }
  const VehicleTilt<T>& tilt() const { return tilt_; }
  /// Makes the tilt a state, at zero. Before the first landmark.
  void start_tilt(const TiltParameters<T>& parameters) {
    tilts_ = TiltStates > 0 && parameters.tilts();
    if (!tilts_) return;
    vehicle_states_ += kTiltStates;
    P_.resize(vehicle_states_);
    P_(kTiltState, kTiltState) = square(parameters.sigma_pitch_rad);
    P_(kTiltState + 1, kTiltState + 1) = square(parameters.sigma_roll_rad);
  }
  /// Lets the tilt return by `decay` and adds `noise`. It is the floor that comes to lie under the
  /// body, a slope of the road: beside the landmarks the body stays as it was, so the mean of the
  /// map turns about the vehicle. The turn is small: the covariance keeps its axes. Cost: 2 n
  /// multiplications, 9 per landmark.
  void propagate_tilt(T decay, const Vector2<T>& noise) {
    const LandmarkMatrix before = vehicle_axes();
    tilt_.pitch *= decay;
    tilt_.roll *= decay;
    turn_map(vehicle_axes() * before.transpose());
    for (int i = 0; i < P_.size(); ++i) {
      T* row = P_.row(i);
      if (i < kTiltState) continue;
      if (i < kTiltState + kTiltStates) {
        for (int j = 0; j < kTiltState; ++j) row[j] *= decay;
        for (int j = kTiltState; j <= i; ++j) row[j] *= decay * decay;
        row[i] += noise(i - kTiltState);
        continue;
      }
      row[kTiltState] *= decay;
      row[kTiltState + 1] *= decay;
    }
  }
  TiltAxes<T> tilt_axes(const RelativeFrame<T>& f) const {
    T sine = T(0);
    T cosine = T(1);
    sin_cos(tilt_.pitch, sine, cosine);
    const T pitch[2] = {T(0), T(1)};
    const T roll[2] = {cosine, T(0)};
    TiltAxes<T> axes;
    f.to_relative(pitch, axes.pitch);
    f.to_relative(roll, axes.roll);
    axes.roll[2] = -sine;
    return axes;
  }
  Matrix2<T> tilt_covariance() const {
    Matrix2<T> covariance = Matrix2<T>::Zero();
    if (!tilts()) return covariance;
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) covariance(i, j) = P_(kTiltState + i, kTiltState + j);
    }
    return covariance;
  }
  void own_tilt_covariance(TiltCovariance<T>& out) const {
    out.own[0] = P_(kTiltState, kTiltState);
    out.own[1] = P_(kTiltState + 1, kTiltState);
    out.own[2] = P_(kTiltState + 1, kTiltState + 1);
  }
  VehicleTilt<T> tilt_after(const T* d) const {
    return {tilt_.pitch + d[kTiltState], tilt_.roll + d[kTiltState + 1]};
  }

  /// Makes the direction of travel a state, at zero. Before the first landmark, after start_tilt().
  void start_travel(T sigma_rad) {
    if (TravelStates == 0 || !(sigma_rad > T(0))) return;
    travels_ = true;
    P_.resize(++vehicle_states_);
    P_(travel_state(), travel_state()) = square(sigma_rad);
  }
  /// Whether the direction of travel is a state.
  bool travels() const { return TravelStates > 0 && travels_; }
  DirectionOfTravel<T> travel() const {
    if (!travels()) return {};
    return {travel_rad_, P_(travel_state(), travel_state())};
  }
  int travel_state() const { return vehicle_states() - 1; }

  /// Puts the mean of the next landmark where it is seen from the vehicle, `y` in its axes.
  void place_beside_vehicle(const LandmarkMatrix& rotation, const LandmarkVector& y) {
    const LandmarkVector turned = rotation * y;
    T* p = p_[landmarks_];
    for (int i = 0; i < LandmarkDim; ++i) p[i] = turned(i);
    for (int i = 0; i < 2; ++i) p[i] += x_[i];
  }
  /// The same for a landmark known in the world.
  void place_in_world(const LandmarkVector& p_world) {
    T* p = p_[landmarks_];
    for (int i = 0; i < LandmarkDim; ++i) p[i] = p_world(i);
    for (int i = 0; i < 2; ++i) p[i] -= anchor_[i];
  }
  /// Counts the landmark in that was placed last and whose states were appended.
  void count_landmark() { ++landmarks_; }

  void remove_landmark(int slot) {
    const int last = landmarks_ - 1;
    for (int i = 0; i < LandmarkDim; ++i) p_[slot][i] = p_[last][i];
    P_.remove_block_unordered(state_of(slot), LandmarkDim);
    landmarks_ = last;
  }
  void widen_landmark(int slot, T variance) {
    const int first = state_of(slot);
    for (int i = 0; i < LandmarkDim; ++i) P_(first + i, first + i) += variance;
  }

  void hash_mean(Hash64& hash) const {
    hash.add(heading_);
    for (int i = 0; i < 2; ++i) hash.add(x_[i]);
    for (int i = 0; i < 2; ++i) hash.add(anchor_[i]);
    if (tilts()) {
      hash.add(tilt_.pitch);
      hash.add(tilt_.roll);
    }
    if (travels()) hash.add(travel_rad_);
    for (int slot = 0; slot < landmarks_; ++slot) {
      for (int i = 0; i < LandmarkDim; ++i) hash.add(p_[slot][i]);
    }
  }

 protected:
  /// Empties the map; the vehicle stands at `pose`, `anchor` + its own coordinates.
  void start_at(const PlanarPose<T>& pose, bool anchored_there) {
    heading_ = wrap_angle(pose.heading);
    for (int i = 0; i < 2; ++i) {
      x_[i] = anchored_there ? T(0) : pose.position(i);
      anchor_[i] = anchored_there ? pose.position(i) : T(0);
    }
    landmarks_ = 0;
    vehicle_states_ = kPoseStates;
    tilts_ = false;
    travels_ = false;
    travel_rad_ = T(0);
    tilt_ = VehicleTilt<T>();
    P_.resize(0);
    P_.resize(kPoseStates);
  }

  void turn_map(const LandmarkMatrix& rotation) {
    for (int slot = 0; slot < landmarks_; ++slot) {
      LandmarkVector v;
      relative(slot, v.data());
      const LandmarkVector turned = rotation * v;
      for (int i = 0; i < LandmarkDim; ++i) p_[slot][i] = turned(i);
      for (int i = 0; i < 2; ++i) p_[slot][i] += x_[i];
    }
  }

  void correct_tilt(const T* d) {
    if (tilts()) tilt_ = tilt_after(d);
  }
  void correct_travel(const T* d) {
    constexpr T kMost_rad = T(0.3);
    if (travels()) travel_rad_ = clamp(travel_rad_ + d[travel_state()], -kMost_rad, kMost_rad);
  }

  T heading_ = T(0);
  VehicleTilt<T> tilt_;
  T travel_rad_ = T(0);
  int vehicle_states_ = kPoseStates;
  bool tilts_ = false;
  bool travels_ = false;
  T x_[2] = {};
  T anchor_[2] = {};
  T p_[MaxLandmarks][LandmarkDim] = {};
  int landmarks_ = 0;
  Covariance P_;
};

}  // namespace cairn::detail
