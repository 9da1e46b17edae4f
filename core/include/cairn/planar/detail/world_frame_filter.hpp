#pragma once

#include "cairn/planar/detail/planar_filter.hpp"

namespace cairn::detail {

/// State and access shared by EkfSlam and GroupIekfSlam: heading, position and landmarks, with
/// three vehicle states and as many per landmark as it has coordinates. Positions are relative to
/// `anchor_`.
template <class Derived, class T, int MaxLandmarks, int LandmarkDim>
class WorldFrameFilter
    : public PlanarFilter<Derived, T, MaxLandmarks, LandmarkDim, 3, LandmarkDim> {
 public:
  using Base = PlanarFilter<Derived, T, MaxLandmarks, LandmarkDim, 3, LandmarkDim>;

  /// Mean pose, the point of linearisation: what images are registered with.
  PlanarPose<T> mean_pose() const {
    PlanarPose<T> pose;
    pose.position = {anchor_[0] + x_[0], anchor_[1] + x_[1]};
    pose.heading = heading_;
    return pose;
  }
  /// Mean landmark, the partner of mean_pose(), m.
  Vector<T, LandmarkDim> mean_landmark(int slot) const {
    Vector<T, LandmarkDim> p;
    for (int i = 0; i < LandmarkDim; ++i) p(i) = p_[slot][i];
    p(0) += anchor_[0];
    p(1) += anchor_[1];
    return p;
  }

  /// Element of the covariance of the filter's own error, pending noise included: EkfSlam (x, y,
  /// heading, landmarks), GroupIekfSlam (heading, xi_x, xi_landmarks). i, j < state_size().
  T error_covariance(int i, int j) const {
    return this->P_(i, j) + this->derived().pending_covariance(i, j);
  }

  /// Fingerprint of mean and covariance.
  void hash(Hash64& hash) const {
    hash.add(heading_);
    for (int i = 0; i < 2; ++i) hash.add(x_[i]);
    for (int i = 0; i < 2; ++i) hash.add(anchor_[i]);
    for (int slot = 0; slot < this->landmark_count(); ++slot) {
      for (int i = 0; i < LandmarkDim; ++i) hash.add(p_[slot][i]);
    }
    this->hash_common(hash);
    this->derived().hash_pending(hash);
  }

 protected:
  friend Base;

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

  /// Places a landmark seen from the vehicle and turns its noise to the world's axes; the new
  /// state's first row.
  int place_landmark(const Vector<T, LandmarkDim>& y, const Matrix<T, LandmarkDim, LandmarkDim>& R,
                     Matrix<T, LandmarkDim, LandmarkDim>& R_world) {
    const RelativeFrame<T> f = frame();
    const int slot = this->table_.size();
    const T body[2] = {y(0), y(1)};
    T turned[2];
    f.to_relative(body, turned);
    p_[slot][0] = x_[0] + turned[0];
    p_[slot][1] = x_[1] + turned[1];
    if constexpr (LandmarkDim > 2) p_[slot][2] = y(2);
    Matrix<T, LandmarkDim, LandmarkDim> rotation = Matrix<T, LandmarkDim, LandmarkDim>::Identity();
    rotation(0, 0) = f.cosine;
    rotation(0, 1) = -f.sine;
    rotation(1, 0) = f.sine;
    rotation(1, 1) = f.cosine;
    const Matrix<T, LandmarkDim, LandmarkDim> half = rotation * R;
    R_world = half * rotation.transpose();
    const int first = this->P_.size();
    this->P_.resize(first + LandmarkDim);
    return first;
  }

  void remove_slot(int slot) {
    const int last = this->table_.size() - 1;
    for (int i = 0; i < LandmarkDim; ++i) p_[slot][i] = p_[last][i];
    this->P_.remove_block_unordered(Base::state_of(slot), LandmarkDim);
  }

  void widen_landmark_by(int slot, T variance) {
    const int first = Base::state_of(slot);
    for (int i = 0; i < LandmarkDim; ++i) this->P_(first + i, first + i) += variance;
  }

  T heading_ = T(0);
  T x_[2] = {};
  T anchor_[2] = {};
  T p_[MaxLandmarks][LandmarkDim] = {};
};

}  // namespace cairn::detail
