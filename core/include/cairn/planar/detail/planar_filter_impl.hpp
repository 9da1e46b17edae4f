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
  const bool sane = p.gate > T(0) && p.ransac_threshold > T(0) && p.rescue_gate > T(0) &&
                    p.reacquire_after >= 0 && p.reacquire_steps >= 0 && p.reacquire_steps <= 20 &&
                    p.reacquire_position_m >= T(0) && p.reacquire_heading_rad >= T(0) &&
                    p.reacquire_landmark_m >= T(0) && p.replace_after >= 0 &&
                    p.ransac.max_hypotheses >= 1 && p.ransac.probability > 0.0F &&
                    p.ransac.probability < 1.0F;
  if (!sane) return Status::kBadConfig;

  parameters_ = parameters;
  health_ = Health{};
  table_.clear();
  P_.resize(0);
  P_.resize(VehicleStates);
  updates_ = 0;
  refused_in_row_ = 0;
  widen_step_ = 0;
  widen_next_ = false;
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
  if (widen_next_) {
    widen_next_ = false;
    const T scale = static_cast<T>(1 << widen_step_);
    derived().widen_pose_by(square(scale * parameters_.reacquire_position_m),
                            square(scale * parameters_.reacquire_heading_rad));
    ++health_.reacquisitions;
    if (++widen_step_ > parameters_.reacquire_steps) {
      widen_step_ = 0;
      refused_in_row_ = 0;
    }
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
Status CAIRN_PLANAR_FILTER::update_points(Span<PointObservation<T>> observations,
                                          UpdateReport& report) {
  if (!initialised_) return Status::kNotInitialised;
  if (observations.size < 0 || observations.size > kMaxObservations) {
    return Status::kInvalidArgument;
  }
  for (const PointObservation<T>& o : observations) {
    if (!all_finite(o.y) || !all_finite(o.R)) {
      ++health_.non_finite_inputs;
      return Status::kNonFiniteInput;
    }
    if (!positive_definite(o.R)) return Status::kInvalidArgument;
  }

  report = UpdateReport{};
  refused_count_ = 0;
  const RelativeFrame<T> frame = derived().frame();
  int count = 0;
  for (int i = 0; i < observations.size; ++i) {
    const int slot = find(observations[i].id);
    if (slot < 0) continue;
    ++report.matches;
    Pair& pair = pairs_[count];
    pair.slot = slot;
    pair.source = i;
    T relative[LandmarkDim];
    RelativeCovariance<T> covariance;
    derived().relative(slot, relative);
    derived().relative_covariance(slot, covariance);
    linearise(observations[i], frame, relative, pair);
    if (admit(pair, covariance, parameters_.gate, report)) ++count;
  }
  use(0, count, report);
  conclude(count, report);
  return Status::kOk;
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::update_range_bearing(Span<RangeBearingObservation<T>> observations,
                                                 T sensor_offset_m, UpdateReport& report) {
  if (!initialised_) return Status::kNotInitialised;
  if (observations.size < 0 || observations.size > kMaxObservations) {
    return Status::kInvalidArgument;
  }
  bool finite = is_finite(sensor_offset_m);
  bool valid = true;
  for (const RangeBearingObservation<T>& o : observations) {
    finite = finite && is_finite(o.range) && is_finite(o.bearing) && is_finite(o.sigma_range) &&
             is_finite(o.sigma_bearing);
    valid = valid && o.range > T(0) && o.sigma_range > T(0) && o.sigma_bearing > T(0) &&
            abs(o.bearing) <= T(1e4);
  }
  if (!finite) {
    ++health_.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (!valid) return Status::kInvalidArgument;

  report = UpdateReport{};
  refused_count_ = 0;
  const RelativeFrame<T> frame = derived().frame();
  int count = 0;
  for (int i = 0; i < observations.size; ++i) {
    const int slot = find(observations[i].id);
    if (slot < 0) continue;
    ++report.matches;
    Pair& pair = pairs_[count];
    pair.slot = slot;
    pair.source = i;
    T relative[LandmarkDim];
    RelativeCovariance<T> covariance;
    derived().relative(slot, relative);
    derived().relative_covariance(slot, covariance);
    if (!linearise(observations[i], sensor_offset_m, frame, relative, pair)) {
      ++health_.innovations_singular;
      continue;
    }
    if (admit(pair, covariance, parameters_.gate, report)) ++count;
  }
  use(0, count, report);
  conclude(count, report);
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

CAIRN_PLANAR_TEMPLATE
bool CAIRN_PLANAR_FILTER::admit(const Pair& pair, const RelativeCovariance<T>& relative, T gate,
                                UpdateReport& report) {
  T squared = T(0);
  if (!innovation_covariance(pair, relative).mahalanobis(pair.innovation, squared)) {
    ++health_.innovations_singular;
    return false;
  }
  if (squared <= gate) return true;
  refuse(pair.slot, report);
  return false;
}

CAIRN_PLANAR_TEMPLATE
void CAIRN_PLANAR_FILTER::refuse(int slot, UpdateReport& report) {
  ++report.gated;
  ++health_.innovations_gated;
  refused_[refused_count_++] = slot;
}

/// Book-keeping after an update: who was refused, and whether the filter has locked itself out.
CAIRN_PLANAR_TEMPLATE
void CAIRN_PLANAR_FILTER::conclude(int used, UpdateReport& report) {
  if (report.matches == 0) return;
  ++updates_;
  for (int k = 0; k < used; ++k) {
    LandmarkStatistics& s = table_.statistics(pairs_[k].slot);
    ++s.seen;
    s.rejected_in_row = 0;
    s.last_seen = updates_;
  }
  for (int k = 0; k < refused_count_; ++k) {
    LandmarkStatistics& s = table_.statistics(refused_[k]);
    ++s.rejected;
    ++s.rejected_in_row;
  }
  health_.innovations_used += static_cast<std::uint32_t>(used);
  if (parameters_.reacquire_after == 0) return;
  if (refused_count_ > used) {
    widen_next_ = ++refused_in_row_ >= parameters_.reacquire_after;
  } else {
    refused_in_row_ = 0;
    widen_step_ = 0;
    widen_next_ = false;
    widen_refused_landmarks();
  }
}

CAIRN_PLANAR_TEMPLATE
void CAIRN_PLANAR_FILTER::widen_refused_landmarks() {
  const auto after = static_cast<std::uint32_t>(parameters_.reacquire_after);
  for (int k = 0; k < refused_count_; ++k) {
    const std::uint32_t in_row = table_.statistics(refused_[k]).rejected_in_row;
    if (in_row < after) continue;
    const std::uint32_t step = in_row - after;
    if (step > static_cast<std::uint32_t>(parameters_.reacquire_steps)) continue;
    const T scale = static_cast<T>(1 << static_cast<int>(step));
    derived().widen_landmark_by(refused_[k], square(scale * parameters_.reacquire_landmark_m));
    ++health_.reacquisitions;
  }
}

/// Sequential update with pairs_[first .. first + count), all linearised at the present mean: the
/// same result as one batch update, without its big matrices.
CAIRN_PLANAR_TEMPLATE
void CAIRN_PLANAR_FILTER::use(int first, int count, UpdateReport& report, bool deviates) {
  if (count <= 0) {
    if (deviates) derived().correct(d_);  // back to the prior
    return;
  }
  const int n = P_.size();
  for (int i = 0; i < n && !deviates; ++i) d_[i] = T(0);
  derived().begin_update();
  T nis = T(0);
  int rank = 0;
  for (int k = first; k < first + count; ++k) {
    if (!whiten(pairs_[k], rank, nis)) {
      ++health_.innovations_singular;
      continue;
    }
    report.nis_dof += 2;
    rank += 2;
    if (rank == kBatch) {
      flush(rank);
      rank = 0;
    }
  }
  flush(rank);
  derived().correct(d_);
  report.nis += static_cast<float>(nis);
}

/// Turns a pair into two unit-variance directions w_[rank], w_[rank + 1] (columns of P H^T L^-T, L
/// L^T = S) and adds their correction to d_. P lacks the `rank` directions of this batch and the
/// noise that is pending; both are low-rank terms -f e^T of the columns.
CAIRN_PLANAR_TEMPLATE
bool CAIRN_PLANAR_FILTER::whiten(const Pair& pair, int rank, T& nis) {
  T* g0 = w_[rank];
  T* g1 = w_[rank + 1];
  columns(pair, g0, g1);
  T relative[LandmarkDim];
  derived().relative_of(pair.slot, g0, relative);
  T s00 = pair.row(0, relative) + pair.r00;
  T s01 = pair.row(1, relative) + pair.r01;
  derived().relative_of(pair.slot, g1, relative);
  T s11 = pair.row(1, relative) + pair.r11;

  const T* e[kBatch] = {};
  T f0[kBatch] = {};
  T f1[kBatch] = {};
  for (int r = 0; r < rank; ++r) {
    e[r] = w_[r];
    derived().relative_of(pair.slot, w_[r], relative);
    f0[r] = pair.row(0, relative);
    f1[r] = pair.row(1, relative);
    s00 -= f0[r] * f0[r];
    s01 -= f0[r] * f1[r];
    s11 -= f1[r] * f1[r];
  }
  int count = rank;
  if (derived().pending_column(pair, g0, g1, e + rank, f0[rank], f1[rank], s00, s01, s11)) ++count;

  Whitening<T> k;
  if (!(s00 > T(0))) return false;
  k.i00 = T(1) / sqrt(s00);
  k.l10 = s01 * k.i00;
  const T rest = s11 - k.l10 * k.l10;
  if (!(rest > T(0))) return false;
  k.i11 = T(1) / sqrt(rest);
  derived().relative_of(pair.slot, d_, relative);
  k.y0 = (pair.innovation[0] - pair.row(0, relative)) * k.i00;
  k.y1 = (pair.innovation[1] - pair.row(1, relative) - k.l10 * k.y0) * k.i11;
  whiten_columns(g0, g1, d_, P_.size(), k, count, e, f0, f1);
  nis += k.y0 * k.y0 + k.y1 * k.y1;
  return true;
}

/// g = P H^T of a pair, without what is pending.
CAIRN_PLANAR_TEMPLATE
void CAIRN_PLANAR_FILTER::columns(const Pair& pair, T* g0, T* g1) {
  if (pair.direct) {
    derived().relative_columns(pair.slot, g0, g1, nullptr);
    return;
  }
  const int n = P_.size();
  derived().relative_columns(pair.slot, g0, g1, LandmarkDim > 2 ? third_ : nullptr);
  for (int i = 0; i < n; ++i) {
    const T c0 = g0[i];
    const T c1 = g1[i];
    g0[i] = pair.h[0][0] * c0 + pair.h[0][1] * c1;
    g1[i] = pair.h[1][0] * c0 + pair.h[1][1] * c1;
    if constexpr (LandmarkDim > 2) {
      g0[i] += pair.h[0][2] * third_[i];
      g1[i] += pair.h[1][2] * third_[i];
    }
  }
}

/// P -= the batch, together with what the filter still has to add to P.
CAIRN_PLANAR_TEMPLATE
void CAIRN_PLANAR_FILTER::flush(int rank) {
  const T* rows[kBatch + 1] = {};
  const T* cols[kBatch + 1] = {};
  for (int r = 0; r < rank; ++r) {
    rows[r] = w_[r];
    cols[r] = w_[r];
  }
  const int extra = derived().pending(rows + rank, cols + rank);
  downdate(P_, rank + extra, rows, cols);
  if (extra > 0) derived().pending_done();
}

}  // namespace cairn::detail
