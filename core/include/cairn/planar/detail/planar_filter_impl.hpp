#pragma once

#define CAIRN_PLANAR_TEMPLATE                                                             \
  template <class Derived, class T, int MaxLandmarks, int LandmarkDim, int VehicleStates, \
            int LandmarkStates>
#define CAIRN_PLANAR_FILTER \
  PlanarFilter<Derived, T, MaxLandmarks, LandmarkDim, VehicleStates, LandmarkStates>

namespace cairn::detail {

template <class T>
inline constexpr T kFarthestLandmark = T(1e5);

template <class T>
inline bool positive_definite(const Matrix2<T>& m) {
  return m(0, 0) > T(0) && m(1, 1) > T(0) && m(0, 1) == m(1, 0) &&
         m(0, 0) * m(1, 1) - m(0, 1) * m(0, 1) > T(0);
}
template <class T>
inline bool positive_definite(const Matrix3<T>& m) {
  const Matrix2<T> corner = m.template topLeftCorner<2, 2>();
  return positive_definite<T>(corner) && m(2, 2) > T(0) && m(0, 2) == m(2, 0) &&
         m(1, 2) == m(2, 1) &&
         m.template topLeftCorner<2, 2>().determinant() * m(2, 2) +
                 T(2) * m(0, 1) * m(1, 2) * m(0, 2) - m(0, 0) * m(1, 2) * m(1, 2) -
                 m(1, 1) * m(0, 2) * m(0, 2) >
             T(0);
}

template <class Matrix>
inline bool all_finite(const Matrix& m) {
  bool finite = true;
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j) finite = finite && is_finite(m(i, j));
  }
  return finite;
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::begin(const PlanarPose<T>& pose, const Matrix3<T>& covariance,
                                  const PlanarParameters<T>& parameters) {
  if (!all_finite(pose.position) || !is_finite(pose.heading) || !all_finite(covariance)) {
    return Status::kNonFiniteInput;
  }
  for (int i = 0; i < 3; ++i) {
    if (!(covariance(i, i) >= T(0))) return Status::kInvalidArgument;
    for (int j = 0; j < i; ++j) {
      const T product = covariance(i, i) * covariance(j, j);
      if (covariance(i, j) != covariance(j, i) ||
          covariance(i, j) * covariance(i, j) > product * T(1.0001)) {
        return Status::kInvalidArgument;
      }
    }
  }
  if (abs(pose.heading) > T(1e4)) return Status::kInvalidArgument;
  const PlanarParameters<T>& p = parameters;
  const bool sane =
      p.gate > T(0) && p.ransac_threshold > T(0) && p.rescue_gate > T(0) &&
      p.reacquire_after >= 0 && p.reacquire_landmark_after >= 1 && p.reacquire_steps >= 0 &&
      p.reacquire_steps <= 20 && p.reacquire_position_m >= T(0) &&
      p.reacquire_heading_rad >= T(0) && p.reacquire_landmark_m >= T(0) && p.replace_after >= 0 &&
      p.ransac.max_hypotheses >= 1 && p.ransac.probability > 0.0F && p.ransac.probability < 1.0F;
  if (!sane) return Status::kBadConfig;

  parameters_ = parameters;
  health_ = Health{};
  table_.clear();
  P_.resize(0);
  P_.resize(VehicleStates);
  updates_ = 0;
  reacquisition_.clear();
  initialised_ = true;
  return Status::kOk;
}

CAIRN_PLANAR_TEMPLATE
void CAIRN_PLANAR_FILTER::hash_common(Hash64& hash) const {
  hash.add(static_cast<std::int32_t>(table_.size()));
  for (int slot = 0; slot < table_.size(); ++slot) hash.add(table_.id(slot));
  const int count = P_.size() * (P_.size() + 1) / 2;
  for (int k = 0; k < count; ++k) hash.add(P_.data()[k]);
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::predict(const PlanarIncrement<T>& increment) {
  if (!initialised_) return Status::kNotInitialised;
  const Status status = validate(increment);
  if (status == Status::kNonFiniteInput) ++health_.non_finite_inputs;
  if (!ok(status)) return status;
  derived().propagate(increment);
  if (reacquisition_.take()) {
    const T scale = static_cast<T>(1 << (reacquisition_.steps() - 1));
    derived().widen_pose_by(square(scale * parameters_.reacquire_position_m),
                            square(scale * parameters_.reacquire_heading_rad));
    ++health_.reacquisitions;
  }
  return Status::kOk;
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::widen_pose(T position_variance, T heading_variance) {
  if (!initialised_) return Status::kNotInitialised;
  if (!is_finite(position_variance) || !is_finite(heading_variance)) return Status::kNonFiniteInput;
  if (position_variance < T(0) || heading_variance < T(0)) return Status::kInvalidArgument;
  derived().widen_pose_by(position_variance, heading_variance);
  return Status::kOk;
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::predict_range_bearing(int slot, T sensor_offset_m, T sigma_range,
                                                  T sigma_bearing,
                                                  RangeBearingPrediction<T>& prediction) const {
  if (!initialised_) return Status::kNotInitialised;
  if (slot < 0 || slot >= table_.size()) return Status::kNotFound;
  if (!(sigma_range > T(0)) || !(sigma_bearing > T(0))) return Status::kInvalidArgument;
  T relative[LandmarkDim];
  RelativeCovariance<T> covariance;
  derived().relative(slot, relative);
  derived().relative_covariance(slot, covariance);
  // Innovations of a sighting at range and bearing zero are minus what is expected.
  RangeBearingObservation<T> zero;
  zero.sigma_range = sigma_range;
  zero.sigma_bearing = sigma_bearing;
  Pair pair;
  if (!linearise(zero, sensor_offset_m, derived().frame(), relative, pair)) {
    return Status::kOutOfView;
  }
  const InnovationCovariance<T> s = innovation_covariance(pair, covariance);
  prediction.range = -pair.innovation[0];
  prediction.bearing = -pair.innovation[1];
  prediction.covariance << s.s00, s.s01, s.s01, s.s11;
  return Status::kOk;
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::add_landmark(LandmarkId id, const Vector<T, LandmarkDim>& y_vehicle,
                                         const Matrix<T, LandmarkDim, LandmarkDim>& R,
                                         LandmarkId* replaced) {
  const Status valid = check_landmark(y_vehicle, R);
  if (!ok(valid)) return valid;
  const Status status = make_room(id, replaced);
  if (!ok(status)) return status;
  derived().append_landmark(y_vehicle, R);
  enter(id);
  return Status::kOk;
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::check_landmark(const Vector<T, LandmarkDim>& p,
                                           const Matrix<T, LandmarkDim, LandmarkDim>& covariance) {
  if (!initialised_) return Status::kNotInitialised;
  if (!all_finite(p) || !all_finite(covariance)) {
    ++health_.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (!positive_definite(covariance)) return Status::kInvalidArgument;
  for (int i = 0; i < LandmarkDim; ++i) {
    if (abs(p(i)) > kFarthestLandmark<T>) return Status::kInvalidArgument;
  }
  return Status::kOk;
}

/// A slot for one more landmark, by replacement where the map is full.
CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::make_room(LandmarkId id, LandmarkId* replaced) {
  if (!initialised_) return Status::kNotInitialised;
  if (id == kNoLandmark) return Status::kInvalidArgument;
  if (find(id) >= 0) return Status::kDuplicate;
  if (replaced != nullptr) *replaced = kNoLandmark;
  if (!table_.full()) return Status::kOk;
  const int slot =
      parameters_.replace_after > 0
          ? table_.replaceable(updates_, static_cast<std::uint32_t>(parameters_.replace_after))
          : -1;
  if (slot < 0) {
    ++health_.landmarks_refused;
    return Status::kFull;
  }
  if (replaced != nullptr) *replaced = table_.id(slot);
  derived().remove_slot(slot);
  table_.remove_unordered(slot);
  ++health_.landmarks_replaced;
  return Status::kOk;
}

CAIRN_PLANAR_TEMPLATE
void CAIRN_PLANAR_FILTER::enter(LandmarkId id) {
  table_.push(id, updates_);
  ++health_.landmarks_added;
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::remove_landmark(int slot) {
  if (!initialised_) return Status::kNotInitialised;
  if (slot < 0 || slot >= table_.size()) return Status::kNotFound;
  derived().remove_slot(slot);
  table_.remove_unordered(slot);
  ++health_.landmarks_removed;
  return Status::kOk;
}

}  // namespace cairn::detail
