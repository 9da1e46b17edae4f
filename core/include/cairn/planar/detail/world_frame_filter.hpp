#pragma once

#include "cairn/planar/detail/landmark_insertion.hpp"
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

  static constexpr bool kHasWorldLandmarks = true;  ///< add_world_landmark()

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

  /// Remembers where the vehicle is now as a state of its own, fully correlated with the pose, for
  /// add_landmark_on_path(). It takes a landmark's slot, is never replaced, and leaves by
  /// remove_landmark(). Errors: kNotInitialised, kInvalidArgument (id 0), kDuplicate, kFull.
  Status add_position(LandmarkId id);

  /// Adds a landmark that was triangulated over the way made since a remembered position, so that
  /// its place in the vehicle frame depends on that way: d y / d (x - x_past) = `by_path`, all in
  /// the vehicle frame; R is the noise that does not. The error of the way, which all landmarks
  /// triangulated over it share, enters through the states' covariance. Errors: as add_landmark(),
  /// kNotFound (no such position), kInvalidArgument.
  Status add_landmark_on_path(LandmarkId id, const Vector<T, LandmarkDim>& y_vehicle,
                              const Matrix<T, LandmarkDim, LandmarkDim>& R, LandmarkId past,
                              const Matrix<T, LandmarkDim, 2>& by_path,
                              LandmarkId* replaced = nullptr);

  /// Adds a landmark known in the world, m, from elsewhere than this filter: its error is that of
  /// `reference`, a remembered position of add_world_position(), plus an independent part. Without
  /// a reference all of it is independent, which the caller must answer for: landmarks of one old
  /// map err together. Errors: as add_landmark(), kNotFound (no such reference).
  Status add_world_landmark(LandmarkId id, const Vector<T, LandmarkDim>& p_world,
                            const Matrix<T, LandmarkDim, LandmarkDim>& covariance,
                            LandmarkId reference = kNoLandmark, LandmarkId* replaced = nullptr);

  /// Adds a place of an old map as a state of its own, which stands for the error that landmarks of
  /// that map share. Kept and removed as those of add_position(). Errors: as add_world_landmark().
  Status add_world_position(LandmarkId id, const Vector<T, LandmarkDim>& p_world,
                            const Matrix<T, LandmarkDim, LandmarkDim>& covariance,
                            LandmarkId reference = kNoLandmark);

  /// Adds a landmark of an old map whose frame is held by two positions of add_world_position(),
  /// `ahead` referring to `origin`: its error is what turn and offset of that frame make of it plus
  /// an independent part. With p = origin + lambda (ahead - origin) in complex numbers of the plane
  /// it is (1 - lambda) that of origin + lambda that of ahead, the height's is origin's. Errors: as
  /// add_world_landmark(), kInvalidArgument (both in one place). Cost: 12 multiply-adds a state.
  Status add_framed_landmark(LandmarkId id, const Vector<T, LandmarkDim>& p_world,
                             const Matrix<T, LandmarkDim, LandmarkDim>& covariance,
                             LandmarkId origin, LandmarkId ahead, LandmarkId* replaced = nullptr);

  /// Adds noise to such a frame: an offset of `position_variance` m^2 per axis, and a turn about
  /// where the vehicle is of `heading_variance` rad^2. kInvalidArgument, kNotFound. Cost: 10
  /// elements of the covariance.
  Status widen_frame(LandmarkId origin, LandmarkId ahead, T position_variance, T heading_variance);

  /// Covariance of a landmark's place as seen from the vehicle, in the world's axes, m^2: without
  /// what the vehicle's own pose is wrong by.
  Matrix<T, LandmarkDim, LandmarkDim> relative_landmark_covariance(int slot) const {
    RelativeCovariance<T> relative;
    this->derived().relative_covariance(slot, relative);
    Matrix<T, LandmarkDim, LandmarkDim> out;
    for (int i = 0; i < LandmarkDim; ++i) {
      for (int j = 0; j <= i; ++j) {
        out(i, j) = relative.s[i * (i + 1) / 2 + j];
        out(j, i) = out(i, j);
      }
    }
    return out;
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

  using LandmarkRows = ErrorRows<T, LandmarkDim>;
  using LandmarkMatrix = Matrix<T, LandmarkDim, LandmarkDim>;

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

  /// Puts the mean of the next landmark where it is seen from the vehicle.
  void place_landmark(const LandmarkMatrix& rotation, const Vector<T, LandmarkDim>& y) {
    const Vector<T, LandmarkDim> turned = rotation * y;
    T* p = p_[this->table_.size()];
    for (int i = 0; i < LandmarkDim; ++i) p[i] = turned(i);
    for (int i = 0; i < 2; ++i) p[i] += x_[i];
  }

  /// The same for a landmark known in the world.
  void place_in_world(const Vector<T, LandmarkDim>& p_world) {
    T* p = p_[this->table_.size()];
    for (int i = 0; i < LandmarkDim; ++i) p[i] = p_world(i);
    for (int i = 0; i < 2; ++i) p[i] -= anchor_[i];
  }

  void append_landmark(const Vector<T, LandmarkDim>& y, const LandmarkMatrix& R) {
    this->derived().add_pending_now();
    const LandmarkMatrix rotation = vehicle_axes();
    place_landmark(rotation, y);
    LandmarkRows rows;
    this->derived().rows_with_vehicle(this->table_.size(), rows);
    const LandmarkMatrix half = rotation * R;
    append_error_rows(this->P_, rows, LandmarkMatrix(half * rotation.transpose()));
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

#define CAIRN_WORLD_TEMPLATE template <class Derived, class T, int MaxLandmarks, int LandmarkDim>
#define CAIRN_WORLD WorldFrameFilter<Derived, T, MaxLandmarks, LandmarkDim>

CAIRN_WORLD_TEMPLATE
Status CAIRN_WORLD::add_position(LandmarkId id) {
  const Status status = this->make_room(id, nullptr);
  if (!ok(status)) return status;
  append_landmark(Vector<T, LandmarkDim>::Zero(), LandmarkMatrix::Zero());
  this->enter(id);
  this->table_.statistics(this->table_.size() - 1).pinned = true;
  return Status::kOk;
}

CAIRN_WORLD_TEMPLATE
Status CAIRN_WORLD::add_landmark_on_path(LandmarkId id, const Vector<T, LandmarkDim>& y_vehicle,
                                         const Matrix<T, LandmarkDim, LandmarkDim>& R,
                                         LandmarkId past, const Matrix<T, LandmarkDim, 2>& by_path,
                                         LandmarkId* replaced) {
  const Status valid = this->check_landmark(y_vehicle, R);
  if (!ok(valid)) return valid;
  if (!all_finite(by_path)) return Status::kNonFiniteInput;
  if (this->find(past) < 0) return Status::kNotFound;
  const Status status = this->make_room(id, replaced);
  if (!ok(status)) return status;
  const int slot = this->find(past);  // after make_room, which moves slots
  this->derived().add_pending_now();
  const LandmarkMatrix rotation = vehicle_axes();
  place_landmark(rotation, y_vehicle);
  LandmarkRows rows;
  this->derived().rows_with_vehicle(this->table_.size(), rows);
  const Matrix<T, LandmarkDim, 2> turned = rotation * by_path;
  const Matrix<T, LandmarkDim, 2> by_world =
      turned * rotation.template topLeftCorner<2, 2>().transpose();
  for (int i = 0; i < LandmarkDim; ++i) {
    for (int k = 0; k < 2; ++k) {
      rows.add(i, Derived::kPositionState + k, by_world(i, k));
      rows.add(i, Base::state_of(slot) + k, -by_world(i, k));
    }
  }
  const LandmarkMatrix half = rotation * R;
  append_error_rows(this->P_, rows, LandmarkMatrix(half * rotation.transpose()));
  this->enter(id);
  return Status::kOk;
}

CAIRN_WORLD_TEMPLATE
Status CAIRN_WORLD::add_world_landmark(LandmarkId id, const Vector<T, LandmarkDim>& p_world,
                                       const Matrix<T, LandmarkDim, LandmarkDim>& covariance,
                                       LandmarkId reference, LandmarkId* replaced) {
  const Status valid = this->check_landmark(p_world, covariance);
  if (!ok(valid)) return valid;
  if (reference != kNoLandmark && this->find(reference) < 0) return Status::kNotFound;
  const Status status = this->make_room(id, replaced);
  if (!ok(status)) return status;
  this->derived().add_pending_now();
  place_in_world(p_world);
  LandmarkRows rows;
  this->derived().rows_in_world(this->table_.size(), rows, T(1));
  if (reference != kNoLandmark) {
    const int shared = this->find(reference);  // after make_room, which moves slots
    this->derived().rows_in_world(shared, rows, T(-1));
    for (int i = 0; i < LandmarkDim; ++i) rows.add(i, Base::state_of(shared) + i, T(1));
  }
  append_error_rows(this->P_, rows, covariance);
  this->enter(id);
  return Status::kOk;
}

CAIRN_WORLD_TEMPLATE
Status CAIRN_WORLD::add_world_position(LandmarkId id, const Vector<T, LandmarkDim>& p_world,
                                       const Matrix<T, LandmarkDim, LandmarkDim>& covariance,
                                       LandmarkId reference) {
  const Status status = add_world_landmark(id, p_world, covariance, reference);
  if (ok(status)) this->table_.statistics(this->table_.size() - 1).pinned = true;
  return status;
}

// Nothing turns with the error of the heading here: in the group's error, xi = p - R(e) p^, the
// terms -J p^ e of origin, ahead and landmark cancel.
CAIRN_WORLD_TEMPLATE
Status CAIRN_WORLD::add_framed_landmark(LandmarkId id, const Vector<T, LandmarkDim>& p_world,
                                        const Matrix<T, LandmarkDim, LandmarkDim>& covariance,
                                        LandmarkId origin, LandmarkId ahead, LandmarkId* replaced) {
  const Status valid = this->check_landmark(p_world, covariance);
  if (!ok(valid)) return valid;
  if (this->find(origin) < 0 || this->find(ahead) < 0) return Status::kNotFound;
  const T* a = p_[this->find(origin)];
  const T* b = p_[this->find(ahead)];
  const T arm[2] = {b[0] - a[0], b[1] - a[1]};
  const T squared = square(arm[0]) + square(arm[1]);
  if (!(squared > T(0))) return Status::kInvalidArgument;
  const T d[2] = {p_world(0) - anchor_[0] - a[0], p_world(1) - anchor_[1] - a[1]};
  const T lambda[2] = {(d[0] * arm[0] + d[1] * arm[1]) / squared,
                       (d[1] * arm[0] - d[0] * arm[1]) / squared};
  const Status status = this->make_room(id, replaced);
  if (!ok(status)) return status;
  this->derived().add_pending_now();
  place_in_world(p_world);
  const int at_origin = Base::state_of(this->find(origin));  // after make_room, which moves slots
  const int at_ahead = Base::state_of(this->find(ahead));
  LandmarkRows rows;
  for (int i = 0; i < 2; ++i) {
    const T across = i == 0 ? -lambda[1] : lambda[1];
    rows.add(i, at_origin + i, T(1) - lambda[0]);
    rows.add(i, at_origin + 1 - i, -across);
    rows.add(i, at_ahead + i, lambda[0]);
    rows.add(i, at_ahead + 1 - i, across);
  }
  if constexpr (LandmarkDim > 2) rows.add(2, at_origin + 2, T(1));
  append_error_rows(this->P_, rows, covariance);
  this->enter(id);
  return Status::kOk;
}

CAIRN_WORLD_TEMPLATE
Status CAIRN_WORLD::widen_frame(LandmarkId origin, LandmarkId ahead, T position_variance,
                                T heading_variance) {
  const int slots[2] = {this->find(origin), this->find(ahead)};
  if (slots[0] < 0 || slots[1] < 0) return Status::kNotFound;
  const bool finite = is_finite(position_variance) && is_finite(heading_variance);
  if (!finite || position_variance < T(0) || heading_variance < T(0)) {
    return Status::kInvalidArgument;
  }
  T by_turn[4];
  for (int k = 0; k < 2; ++k) {
    by_turn[2 * k] = x_[1] - p_[slots[k]][1];
    by_turn[2 * k + 1] = p_[slots[k]][0] - x_[0];
  }
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j <= i; ++j) {
      const T shift = i % 2 == j % 2 ? position_variance : T(0);
      this->P_(Base::state_of(slots[i / 2]) + i % 2, Base::state_of(slots[j / 2]) + j % 2) +=
          shift + by_turn[i] * heading_variance * by_turn[j];
    }
  }
  if constexpr (LandmarkDim > 2) {
    const int height = Base::state_of(slots[0]) + 2;
    this->P_(height, height) += position_variance;
  }
  return Status::kOk;
}

#undef CAIRN_WORLD_TEMPLATE
#undef CAIRN_WORLD

}  // namespace cairn::detail
