#pragma once

#include "cairn/planar/error_model/landmark_insertion.hpp"
#include "cairn/planar/planar_slam.hpp"

// PlanarSlam: landmarks come and go, and so does the place where the vehicle is.

namespace cairn {

namespace detail {
template <class T>
inline constexpr T kFarthestLandmark = T(1e5);
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::check_landmark(const LandmarkVector& p,
                                              const LandmarkMatrix& covariance) {
  if (!initialised_) return Status::kNotInitialised;
  if (!all_finite(p) || !all_finite(covariance)) {
    ++health_.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (!positive_definite(covariance)) return Status::kInvalidArgument;
  for (int i = 0; i < kLandmarkDim; ++i) {
    const bool far = abs(p(i)) > detail::kFarthestLandmark<T>;
    if (far || covariance(i, i) > kMostPositionVariance<T>) return Status::kInvalidArgument;
  }
  return Status::kOk;
}

/// A slot for one more landmark, by replacement where the map is full; slots may move. Ends a rest:
/// a new landmark is something to learn.
template <class ErrorModel>
Status PlanarSlam<ErrorModel>::make_room(LandmarkId id, LandmarkId* replaced,
                                         detail::NeededLandmarks needed) {
  if (!initialised_) return Status::kNotInitialised;
  if (id == kNoLandmark) return Status::kInvalidArgument;
  if (find(id) >= 0) return Status::kDuplicate;
  if (replaced != nullptr) *replaced = kNoLandmark;
  if (!slots_.full()) {
    end_rest();
    return Status::kOk;
  }
  const int slot =
      parameters_.replace_after > 0
          ? slots_.replaceable(updates_, static_cast<std::uint32_t>(parameters_.replace_after))
          : -1;
  const LandmarkId leaving = slot < 0 ? kNoLandmark : slots_.id(slot);
  if (slot < 0 || needed.has(leaving)) {
    ++health_.landmarks_refused;
    return Status::kFull;
  }
  if (replaced != nullptr) *replaced = leaving;
  end_rest();
  model_.remove_landmark(slot);
  slots_.remove_unordered(slot);
  ++health_.landmarks_replaced;
  return Status::kOk;
}

template <class ErrorModel>
void PlanarSlam<ErrorModel>::enter(LandmarkId id, bool pinned) {
  slots_.push(id, updates_);
  slots_.statistics(slots_.size() - 1).pinned = pinned;
  ++health_.landmarks_added;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::remove_landmark(int slot) {
  if (!initialised_) return Status::kNotInitialised;
  if (slot < 0 || slot >= slots_.size()) return Status::kNotFound;
  model_.remove_landmark(slot);
  slots_.remove_unordered(slot);
  ++health_.landmarks_removed;
  return Status::kOk;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::add_landmark(LandmarkId id, const LandmarkVector& y_vehicle,
                                            const LandmarkMatrix& R, LandmarkId* replaced) {
  const Status valid = check_landmark(y_vehicle, R);
  if (!ok(valid)) return valid;
  const Status status = make_room(id, replaced);
  if (!ok(status)) return status;
  update_.absorb_deferred_noise(model_);
  model_.append_landmark(y_vehicle, R);
  enter(id);
  return Status::kOk;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::add_position(LandmarkId id) {
  const Status status = make_room(id, nullptr);
  if (!ok(status)) return status;
  update_.absorb_deferred_noise(model_);
  model_.append_position();
  enter(id, true);
  return Status::kOk;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::add_landmark_on_path(LandmarkId id, const LandmarkVector& y_vehicle,
                                                    const LandmarkMatrix& R, LandmarkId past,
                                                    const Matrix<T, kLandmarkDim, 2>& by_path,
                                                    LandmarkId* replaced) {
  const Status valid = check_landmark(y_vehicle, R);
  if (!ok(valid)) return valid;
  if (!all_finite(by_path)) return Status::kNonFiniteInput;
  for (int i = 0; i < 2 * kLandmarkDim; ++i) {
    if (abs(by_path(i / 2, i % 2)) > detail::kFarthestLandmark<T>) return Status::kInvalidArgument;
  }
  if (find(past) < 0) return Status::kNotFound;
  const Status status = make_room(id, replaced, {past});
  if (!ok(status)) return status;
  update_.absorb_deferred_noise(model_);
  model_.append_landmark_on_path(y_vehicle, R, find(past), by_path);
  enter(id);
  return Status::kOk;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::add_world_landmark(LandmarkId id, const LandmarkVector& p_world,
                                                  const LandmarkMatrix& covariance,
                                                  LandmarkId reference, LandmarkId* replaced) {
  if constexpr (!kHasWorldLandmarks) {
    return Status::kInvalidArgument;
  } else {
    const Status status = make_room_in_world(id, p_world, covariance, reference, replaced);
    if (!ok(status)) return status;
    detail::append_of_world(model_, p_world, covariance, find(reference));
    enter(id);
    return Status::kOk;
  }
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::make_room_in_world(LandmarkId id, const LandmarkVector& p_world,
                                                  const LandmarkMatrix& covariance,
                                                  LandmarkId reference, LandmarkId* replaced) {
  const Status valid = check_landmark(p_world, covariance);
  if (!ok(valid)) return valid;
  if (reference != kNoLandmark && find(reference) < 0) return Status::kNotFound;
  const Status status = make_room(id, replaced, {reference});
  if (ok(status)) update_.absorb_deferred_noise(model_);
  return status;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::add_frame_position(LandmarkId id, const LandmarkVector& p_world,
                                                  const LandmarkMatrix& covariance,
                                                  LandmarkId reference) {
  if constexpr (!kHasWorldLandmarks) {
    return Status::kInvalidArgument;
  } else {
    const Status status = make_room_in_world(id, p_world, covariance, reference, nullptr);
    if (!ok(status)) return status;
    detail::append_beside_vehicle(model_, p_world, covariance, find(reference));
    enter(id, true);
    return Status::kOk;
  }
}

/// In complex numbers of the plane the pose in the frame is (x - origin) / (ahead - origin), whose
/// error is that of x without (1 - lambda) origin's and lambda ahead's. The group's error turns all
/// of them and the heading by the same angle.
template <class ErrorModel>
Matrix3<typename ErrorModel::Scalar> PlanarSlam<ErrorModel>::framed_pose_covariance(
    LandmarkId origin, LandmarkId ahead) const {
  if constexpr (!kHasWorldLandmarks) {
    return Matrix3<T>::Zero();
  } else {
    constexpr int kTerms = 7;
    const int o = model_.state_of(find(origin));
    const int a = model_.state_of(find(ahead));
    constexpr int kX = ErrorModel::kPositionState;
    const int index[kTerms] = {ErrorModel::kHeadingState, kX, kX + 1, o, o + 1, a, a + 1};
    T lambda[2] = {};
    LandmarkVector x = LandmarkVector::Zero();
    x.template head<2>() = model_.mean_pose().position;
    static_cast<void>(detail::place_in_frame(model_, x, find(origin), find(ahead), lambda));
    const Vector2<T> arm =
        (model_.mean_landmark(find(ahead)) - model_.mean_landmark(find(origin))).template head<2>();
    const T per_arm = T(1) / arm.squaredNorm();
    const T turn[2] = {arm.y() * per_arm, -arm.x() * per_arm};
    const T own = ErrorModel::kTurnsAboutAnchor ? T(0) : T(1);
    const T rows[3][kTerms] = {
        {T(0), T(1), T(0), lambda[0] - T(1), -lambda[1], -lambda[0], lambda[1]},
        {T(0), T(0), T(1), lambda[1], lambda[0] - T(1), -lambda[1], -lambda[0]},
        {own, T(0), T(0), -turn[0], -turn[1], turn[0], turn[1]}};
    Matrix3<T> out = Matrix3<T>::Zero();
    for (int k = 0; k < kTerms; ++k) {
      for (int l = 0; l < kTerms; ++l) {
        const T c = error_covariance(index[k], index[l]);
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j) out(i, j) += rows[i][k] * c * rows[j][l];
        }
      }
    }
    return out;
  }
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::drift_world(T position_variance, T heading_variance) {
  if (!initialised_) return Status::kNotInitialised;
  const bool finite = is_finite(position_variance) && is_finite(heading_variance);
  if (!finite || position_variance < T(0) || heading_variance < T(0)) {
    return Status::kInvalidArgument;
  }
  if constexpr (ErrorModel::kTurnsAboutAnchor) {
    model_.drift_world(detail::at_most(position_variance, kMostPositionVariance<T>),
                       detail::at_most(heading_variance, kMostHeadingVariance<T>));
  }
  return Status::kOk;
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::add_framed_landmark(LandmarkId id, const LandmarkVector& p_world,
                                                   const LandmarkMatrix& covariance,
                                                   LandmarkId origin, LandmarkId ahead,
                                                   LandmarkId* replaced) {
  if constexpr (!kHasWorldLandmarks) {
    return Status::kInvalidArgument;
  } else {
    const Status valid = check_landmark(p_world, covariance);
    if (!ok(valid)) return valid;
    if (find(origin) < 0 || find(ahead) < 0) return Status::kNotFound;
    T lambda[2];
    if (!detail::place_in_frame(model_, p_world, find(origin), find(ahead), lambda)) {
      return Status::kInvalidArgument;
    }
    const Status status = make_room(id, replaced, {origin, ahead});
    if (!ok(status)) return status;
    update_.absorb_deferred_noise(model_);
    detail::append_of_frame(model_, p_world, covariance, find(origin), find(ahead), lambda);
    enter(id);
    return Status::kOk;
  }
}

template <class ErrorModel>
Status PlanarSlam<ErrorModel>::widen_frame(LandmarkId origin, LandmarkId ahead, T position_variance,
                                           T heading_variance) {
  if constexpr (!kHasWorldLandmarks) {
    return Status::kInvalidArgument;
  } else {
    const int at_origin = find(origin);
    const int at_ahead = find(ahead);
    if (at_origin < 0 || at_ahead < 0) return Status::kNotFound;
    const bool finite = is_finite(position_variance) && is_finite(heading_variance);
    if (!finite || position_variance < T(0) || heading_variance < T(0)) {
      return Status::kInvalidArgument;
    }
    end_rest();
    detail::widen_frame(model_, at_origin, at_ahead,
                        detail::at_most(position_variance, kMostPositionVariance<T>),
                        detail::at_most(heading_variance, kMostHeadingVariance<T>));
    return Status::kOk;
  }
}

template <class ErrorModel>
typename PlanarSlam<ErrorModel>::Placement PlanarSlam<ErrorModel>::place(const PlanarPose<T>& pose,
                                                                         T position_variance,
                                                                         T heading_variance) {
  Placement before{mean_pose(), {}};
  if constexpr (kHasWorldLandmarks) {
    before.waiting_noise = model_.waiting_noise();
    model_.move_pose(pose);
    model_.bound_waiting_noise(position_variance, heading_variance);
  }
  return before;
}

template <class ErrorModel>
void PlanarSlam<ErrorModel>::put_back(const Placement& before) {
  if constexpr (kHasWorldLandmarks) {
    model_.move_pose(before.pose);
    model_.set_waiting_noise(before.waiting_noise);
  }
}

}  // namespace cairn
