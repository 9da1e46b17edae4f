#pragma once

namespace cairn::detail {

CAIRN_PLANAR_TEMPLATE
template <class Observation, class Check>
Status CAIRN_PLANAR_FILTER::check_observations(Span<Observation> observations, Check check) {
  if (!initialised_) return Status::kNotInitialised;
  if (observations.size < 0 || observations.size > kMaxObservations) {
    return Status::kInvalidArgument;
  }
  Status worst = Status::kOk;
  for (const Observation& o : observations) {
    const Status status = check(o);
    if (status == Status::kNonFiniteInput) {
      ++health_.non_finite_inputs;
      return status;
    }
    if (!ok(status)) worst = status;
  }
  return worst;
}

/// Updates with the observations of known landmarks that pass their gates. `linearise` fills a
/// pair's rows, false where there are none.
CAIRN_PLANAR_TEMPLATE
template <class Observation, class Linearise>
void CAIRN_PLANAR_FILTER::update_with(Span<Observation> observations, Linearise linearise,
                                      UpdateReport& report) {
  report = UpdateReport{};
  refused_count_ = 0;
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
    if (!linearise(observations[i], relative, pair)) {
      ++health_.innovations_singular;
      continue;
    }
    if (admit(pair, covariance, parameters_.gate, report)) ++count;
  }
  use(0, count, report);
  conclude(count, report);
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::update_points(Span<PointObservation<T>> observations,
                                          UpdateReport& report) {
  const Status status = check_observations(observations, [](const PointObservation<T>& o) {
    if (!all_finite(o.y) || !all_finite(o.R)) return Status::kNonFiniteInput;
    return positive_definite(o.R) ? Status::kOk : Status::kInvalidArgument;
  });
  if (!ok(status)) return status;
  const RelativeFrame<T> frame = derived().frame();
  update_with(
      observations,
      [&frame](const PointObservation<T>& o, const T* relative, Pair& pair) {
        linearise(o, frame, relative, pair);
        return true;
      },
      report);
  return Status::kOk;
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::update_range_bearing(Span<RangeBearingObservation<T>> observations,
                                                 T sensor_offset_m, UpdateReport& report) {
  const auto check = [sensor_offset_m](const RangeBearingObservation<T>& o) {
    if (!is_finite(sensor_offset_m) || !is_finite(o.range) || !is_finite(o.bearing) ||
        !is_finite(o.sigma_range) || !is_finite(o.sigma_bearing)) {
      return Status::kNonFiniteInput;
    }
    const bool valid = o.range > T(0) && o.sigma_range > T(0) && o.sigma_bearing > T(0) &&
                       abs(o.bearing) <= T(1e4);
    return valid ? Status::kOk : Status::kInvalidArgument;
  };
  const Status status = check_observations(observations, check);
  if (!ok(status)) return status;
  const RelativeFrame<T> frame = derived().frame();
  update_with(
      observations,
      [&frame, sensor_offset_m](const RangeBearingObservation<T>& o, const T* relative,
                                Pair& pair) {
        return linearise(o, sensor_offset_m, frame, relative, pair);
      },
      report);
  return Status::kOk;
}

CAIRN_PLANAR_TEMPLATE
Status CAIRN_PLANAR_FILTER::update_height(LandmarkId id, T height_m, T sigma_m, T gate) {
  if constexpr (LandmarkDim != 3) {
    return Status::kInvalidArgument;
  } else {
    if (!initialised_) return Status::kNotInitialised;
    if (!is_finite(height_m) || !is_finite(sigma_m)) return Status::kNonFiniteInput;
    if (!(sigma_m > T(0)) || !(gate > T(0))) return Status::kInvalidArgument;
    Pair& pair = pairs_[0];
    pair = Pair();
    pair.slot = find(id);
    if (pair.slot < 0) return Status::kNotFound;
    T relative[3];
    RelativeCovariance<T> covariance;
    derived().relative(pair.slot, relative);
    derived().relative_covariance(pair.slot, covariance);
    pair.innovation[0] = height_m - relative[2];
    pair.h[0][2] = T(1);
    pair.r00 = square(sigma_m);
    pair.r11 = T(1);  // the second row measures nothing
    T squared = T(0);
    if (!innovation_covariance(pair, covariance).mahalanobis(pair.innovation, squared)) {
      ++health_.innovations_singular;
      return Status::kSingular;
    }
    if (!(squared <= gate)) return Status::kGated;
    UpdateReport report;
    use(0, 1, report);
    return Status::kOk;
  }
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
  int again = 0;
  for (int k = 0; k < refused_count_; ++k) {
    LandmarkStatistics& s = table_.statistics(refused_[k]);
    ++s.rejected;
    if (++s.rejected_in_row > 1) ++again;
  }
  health_.innovations_used += static_cast<std::uint32_t>(used);
  if (parameters_.reacquire_after == 0) return;
  reacquisition_.note(used, again, parameters_.reacquire_after, parameters_.reacquire_steps);
  if (reacquisition_.accepted()) widen_refused_landmarks();
}

CAIRN_PLANAR_TEMPLATE
void CAIRN_PLANAR_FILTER::widen_refused_landmarks() {
  const auto after = static_cast<std::uint32_t>(parameters_.reacquire_landmark_after);
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
    if (rank == kMostRank) {
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

  Whitening<T> k;
  for (int r = 0; r < rank; ++r) {
    derived().relative_of(pair.slot, w_[r], relative);
    k.f0[r] = pair.row(0, relative);
    k.f1[r] = pair.row(1, relative);
    s00 -= k.f0[r] * k.f0[r];
    s01 -= k.f0[r] * k.f1[r];
    s11 -= k.f1[r] * k.f1[r];
  }
  const T* extra = derived().pending_column(pair, g0, g1, k.f0[rank], k.f1[rank], s00, s01, s11);

  if (!(s00 > T(0))) return false;
  k.i00 = T(1) / sqrt(s00);
  k.l10 = s01 * k.i00;
  const T rest = s11 - k.l10 * k.l10;
  if (!(rest > T(0))) return false;
  k.i11 = T(1) / sqrt(rest);
  derived().relative_of(pair.slot, d_, relative);
  k.y0 = (pair.innovation[0] - pair.row(0, relative)) * k.i00;
  k.y1 = (pair.innovation[1] - pair.row(1, relative) - k.l10 * k.y0) * k.i11;
  whiten_columns(g0, g1, d_, P_.size(), k, w_, rank, extra);
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
  LowRank<T, kStates> by;
  by.w = w_;
  by.rank = rank;
  by.extra = derived().pending();
  downdate(P_, by);
  if (by.extra != nullptr) derived().pending_done();
}

}  // namespace cairn::detail

#undef CAIRN_PLANAR_TEMPLATE
#undef CAIRN_PLANAR_FILTER
