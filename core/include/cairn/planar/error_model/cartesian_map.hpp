#pragma once

#include "cairn/base/hash.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/planar/observation/linearised_observation.hpp"
#include "cairn/planar/types.hpp"

namespace cairn::detail {

/// What the error models have in common whose landmarks are points of the world: the mean, heading,
/// position and landmarks, and the storage of the covariance, with three vehicle states and as many
/// per landmark as it has coordinates. Positions are kept relative to an anchor.
template <class T, int MaxLandmarks, int LandmarkDim>
class CartesianMap {
 public:
  using Scalar = T;
  static constexpr int kMaxLandmarks = MaxLandmarks;
  static constexpr int kLandmarkDim = LandmarkDim;
  static constexpr int kVehicleStates = 3;
  static constexpr int kLandmarkStates = LandmarkDim;
  static constexpr int kStates = kVehicleStates + MaxLandmarks * kLandmarkStates;
  static constexpr bool kHasWorldLandmarks = true;
  using Covariance = PackedSymmetric<T, kStates>;
  using LandmarkVector = Vector<T, LandmarkDim>;
  using LandmarkMatrix = Matrix<T, LandmarkDim, LandmarkDim>;

  static int state_of(int slot) { return kVehicleStates + slot * kLandmarkStates; }
  int landmark_count() const { return landmarks_; }
  Covariance& covariance() { return P_; }
  const Covariance& covariance() const { return P_; }

  PlanarPose<T> mean_pose() const {
    PlanarPose<T> pose;
    pose.position = {anchor_[0] + x_[0], anchor_[1] + x_[1]};
    pose.heading = heading_;
    return pose;
  }
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

  /// Rotation from the vehicle's axes to the world's.
  LandmarkMatrix vehicle_axes() const {
    const RelativeFrame<T> f = frame();
    LandmarkMatrix rotation = LandmarkMatrix::Identity();
    rotation(0, 0) = f.cosine;
    rotation(0, 1) = -f.sine;
    rotation(1, 0) = f.sine;
    rotation(1, 1) = f.cosine;
    return rotation;
  }
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
    P_.resize(0);
    P_.resize(kVehicleStates);
  }

  T heading_ = T(0);
  T x_[2] = {};
  T anchor_[2] = {};
  T p_[MaxLandmarks][LandmarkDim] = {};
  int landmarks_ = 0;
  Covariance P_;
};

}  // namespace cairn::detail
