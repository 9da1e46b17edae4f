#pragma once

#include "cairn/numeric/positive_definite.hpp"
#include "cairn/planar/detail/deferred_noise.hpp"
#include "cairn/planar/detail/low_rank.hpp"
#include "cairn/planar/observation/linearised_observation.hpp"

namespace cairn::detail {

/// Kalman update of an error model with observations that are all linearised at one mean, one after
/// the other: the same result as one batch update, without its big matrices. Each observation
/// becomes two unit-variance directions, columns of P H^T L^-T with L L^T = S. P takes them away
/// kMostRank at a time, in one pass; until then, and while the model's noise is deferred, P lacks
/// low-rank terms which are added where P is read.
///
/// `Model`: an error model, see PlanarSlam. Holds the scratch memory of one update.
template <class Model>
class WhitenedUpdate {
 public:
  using T = typename Model::Scalar;
  using Observation = LinearisedObservation<T, Model::kLandmarkDim>;

  /// The correction of the mean gathered so far, in the model's error coordinates.
  const T* correction() const { return correction_; }
  /// Direction r (0 or 1) of the last add_to_empty_batch().
  const T* direction(int r) const { return directions_[r]; }

  /// Takes the model's deferred noise as it is at the present mean. Before add_to_empty_batch().
  void begin(Model& model) {
    if constexpr (Model::kDefersNoise) deferred_ = model.deferred_noise();
    if constexpr (kTilts) {
      if (model.tilts()) axes_ = model.tilt_axes(model.frame());
    }
  }
  /// Rows of an observation by the tilt, at the mean that begin() saw; zero where it has none.
  TiltRows<T> tilt_rows(const Model& model, const Observation& o) const {
    if constexpr (kTilts) {
      if (o.tilts) {
        T relative[3];
        model.relative(o.slot, relative);
        return TiltRows<T>(o, relative, axes_);
      }
    }
    return {};
  }
  /// The two rows of an observation on a vector over the states.
  void rows_of(const Model& model, const Observation& o, const TiltRows<T>& tilt, const T* v,
               T (&out)[2]) const {
    T relative[Model::kLandmarkDim];
    model.relative_of(o.slot, v, relative);
    out[0] = o.row(0, relative);
    out[1] = o.row(1, relative);
    if constexpr (kTilts) {
      if (!o.tilts) return;
      out[0] += tilt.row(0, v + Model::kTiltState);
      out[1] += tilt.row(1, v + Model::kTiltState);
    }
  }

  /// Starts a batch with one observation, P untouched: correction() and direction() are its own.
  /// False when its innovation covariance is not positive definite.
  bool add_to_empty_batch(const Model& model, const Observation& observation) {
    clear_correction(model);
    T nis = T(0);
    return add(model, observation, 0, nis);
  }

  /// Moves the mean by the correction and keeps its opposite as the prior's own deviation, which
  /// the next apply() with `deviates` counts in.
  void move_mean(Model& model) {
    if (!correction_is_finite(model)) clear_correction(model);
    model.correct(correction_);
    const int n = model.covariance().size();
    for (int i = 0; i < n; ++i) correction_[i] = -correction_[i];
  }

  /// Updates mean and covariance with `count` observations and adds to `nis` and `rows` what it
  /// used; the number of observations left out, their innovation covariance not being positive
  /// definite. `deviates`: the mean was moved away from the prior by move_mean().
  /// Cost: per observation 2 n for each column of its batch, and n (n + 1) for the covariance.
  int apply(Model& model, const Observation* observations, int count, bool deviates, T& nis,
            int& rows) {
    if (count <= 0) {
      if (deviates) model.correct(correction_);  // back to the prior
      return 0;
    }
    if (!deviates) clear_correction(model);
    begin(model);
    inflate_variances(model);
    int singular = 0;
    int rank = 0;
    for (int k = 0; k < count; ++k) {
      if (!add(model, observations[k], rank, nis)) {
        ++singular;
        continue;
      }
      rows += observations[k].rows;
      rank += 2;
      if (rank == kMostRank) {
        change_covariance(model, rank);
        rank = 0;
      }
    }
    change_covariance(model, rank);
    if (!correction_is_finite(model)) {
      clear_correction(model);
      ++singular;
    }
    model.correct(correction_);
    return singular;
  }

  /// Adds the model's deferred noise to P now.
  void absorb_deferred_noise(Model& model) {
    begin(model);
    change_covariance(model, 0);
  }

 private:
  static constexpr bool kTilts = Model::kTiltStates > 0;

  void clear_correction(const Model& model) {
    const int n = model.covariance().size();
    for (int i = 0; i < n; ++i) correction_[i] = T(0);
  }

  bool correction_is_finite(const Model& model) const {
    const int n = model.covariance().size();
    T product = T(0);  // not a number as soon as one of them is not finite
    for (int i = 0; i < n; ++i) product += T(0) * correction_[i];
    return product == T(0);
  }

  /// Process noise for the arithmetic of the passes that follow, by the size of what they work on.
  void inflate_variances(Model& model) const {
    auto& P = model.covariance();
    P.inflate_diagonal(kRoundingNoise<T>);
    if (deferred_.along == nullptr) return;
    for (int i = 0; i < P.size(); ++i) {
      P.row(i)[i] += kRoundingNoise<T> * square(deferred_.along[i]);
    }
  }

  /// Appends the two directions of an observation to a batch of `rank` and adds their correction.
  bool add(const Model& model, const Observation& o, int rank, T& nis) {
    T* g0 = directions_[rank];
    T* g1 = directions_[rank + 1];
    const TiltRows<T> tilt = tilt_rows(model, o);
    project(model, o, tilt, g0, g1);
    InnovationCovariance<T> s = innovation_of_columns(model, o, tilt, g0, g1);
    Whitening<T> k;
    subtract_batch(model, o, tilt, rank, k, s);
    if constexpr (Model::kDefersNoise) {
      if (deferred_.along != nullptr) add_deferred(model, o, rank, g0, g1, k, s);
    }
    add_rounding_noise(model, o, s);
    if (!factorise(s, k)) return false;
    whiten_innovation(model, o, tilt, k);
    whiten_columns(g0, g1, correction_, model.covariance().size(), k, directions_, rank,
                   deferred_.along);
    nis += k.y0 * k.y0 + k.y1 * k.y1;
    return true;
  }

  /// g = P H^T, P as it is stored.
  void project(const Model& model, const Observation& o, const TiltRows<T>& tilt, T* g0, T* g1) {
    constexpr int kDim = Model::kLandmarkDim;
    model.relative_columns(o.slot, g0, g1);
    if (o.direct) return;
    const auto& P = model.covariance();
    const int n = P.size();
    for (int i = 0; i < n; ++i) {
      const T c0 = g0[i];
      const T c1 = g1[i];
      g0[i] = o.h[0][0] * c0 + o.h[0][1] * c1;
      g1[i] = o.h[1][0] * c0 + o.h[1][1] * c1;
    }
    if constexpr (kDim > 2) {
      P.add_column(model.height_state(o.slot), o.h[0][2], o.h[1][2], g0, g1);
    }
    if constexpr (kTilts) {
      if (!o.tilts) return;
      for (int k = 0; k < 2; ++k) {
        P.add_column(Model::kTiltState + k, tilt.t[0][k], tilt.t[1][k], g0, g1);
      }
    }
  }

  /// S = H g + R, P as it is stored.
  InnovationCovariance<T> innovation_of_columns(const Model& model, const Observation& o,
                                                const TiltRows<T>& tilt, const T* g0,
                                                const T* g1) const {
    T rows[2];
    InnovationCovariance<T> s;
    rows_of(model, o, tilt, g0, rows);
    s.s00 = rows[0] + o.r00;
    s.s01 = rows[1] + o.r01;
    rows_of(model, o, tilt, g1, rows);
    s.s11 = rows[1] + o.r11;
    return s;
  }

  /// The directions of the batch that P lacks: their factors in the columns, and their part of S.
  void subtract_batch(const Model& model, const Observation& o, const TiltRows<T>& tilt, int rank,
                      Whitening<T>& k, InnovationCovariance<T>& s) const {
    T rows[2];
    for (int r = 0; r < rank; ++r) {
      rows_of(model, o, tilt, directions_[r], rows);
      k.f0[r] = rows[0];
      k.f1[r] = rows[1];
      s.s00 -= k.f0[r] * k.f0[r];
      s.s01 -= k.f0[r] * k.f1[r];
      s.s11 -= k.f1[r] * k.f1[r];
    }
  }

  /// The same for the deferred noise: `along` by its factors, `rest` into the columns at once.
  void add_deferred(const Model& model, const Observation& o, int rank, T* g0, T* g1,
                    Whitening<T>& k, InnovationCovariance<T>& s) const {
    T relative[Model::kLandmarkDim];
    model.relative_of(o.slot, deferred_.along, relative);
    T& f0 = k.f0[rank];
    T& f1 = k.f1[rank];
    f0 = -o.row(0, relative);
    f1 = -o.row(1, relative);
    s.s00 += f0 * f0;
    s.s01 += f0 * f1;
    s.s11 += f1 * f1;
    const T h[2][2] = {{o.direct ? T(1) : o.h[0][0], o.direct ? T(0) : o.h[0][1]},
                       {o.direct ? T(0) : o.h[1][0], o.direct ? T(1) : o.h[1][1]}};
    const T* rest = deferred_.rest;
    T by_rest[2][2];
    for (int r = 0; r < 2; ++r) {
      by_rest[r][0] = rest[0] * h[r][0] + rest[1] * h[r][1];
      by_rest[r][1] = rest[1] * h[r][0] + rest[2] * h[r][1];
    }
    for (int i = 0; i < 2; ++i) {
      g0[Model::kPositionState + i] -= by_rest[0][i];
      g1[Model::kPositionState + i] -= by_rest[1][i];
      s.s00 += h[0][i] * by_rest[0][i];
      s.s01 += h[0][i] * by_rest[1][i];
      s.s11 += h[1][i] * by_rest[1][i];
    }
  }

  /// What S cannot resolve counts as measurement noise: else a measurement far better than the
  /// arithmetic would take from P what it does not hold.
  static void add_rounding_noise(const Model& model, const Observation& o,
                                 InnovationCovariance<T>& s) {
    T scale[Model::kLandmarkDim];
    model.relative_scale(o.slot, scale);
    if (o.direct) {
      s.s00 += kRoundingNoise<T> * scale[0];
      s.s11 += kRoundingNoise<T> * scale[1];
      return;
    }
    T sums[2] = {};
    for (int r = 0; r < 2; ++r) {
      for (int i = 0; i < Model::kLandmarkDim; ++i) sums[r] += square(o.h[r][i]) * scale[i];
    }
    s.s00 += kRoundingNoise<T> * sums[0];
    s.s11 += kRoundingNoise<T> * sums[1];
  }

  /// S = L L^T; false when it is not positive definite.
  static bool factorise(const InnovationCovariance<T>& s, Whitening<T>& k) {
    if (!(s.s00 > T(0))) return false;
    k.i00 = T(1) / sqrt(s.s00);
    k.l10 = s.s01 * k.i00;
    const T rest = s.s11 - k.l10 * k.l10;
    if (!(rest > T(0))) return false;
    k.i11 = T(1) / sqrt(rest);
    return true;
  }

  /// y = L^-1 (innovation at the mean corrected so far).
  void whiten_innovation(const Model& model, const Observation& o, const TiltRows<T>& tilt,
                         Whitening<T>& k) const {
    T rows[2];
    rows_of(model, o, tilt, correction_, rows);
    k.y0 = (o.innovation[0] - rows[0]) * k.i00;
    k.y1 = (o.innovation[1] - rows[1] - k.l10 * k.y0) * k.i11;
  }

  /// P -= the batch, together with the deferred noise that P lacks.
  void change_covariance(Model& model, int rank) {
    LowRank<T, Model::kStates> by;
    by.w = directions_;
    by.rank = rank;
    by.extra = deferred_.along;
    auto& P = model.covariance();
    downdate(P, by);
    if constexpr (Model::kDefersNoise) {
      if (by.extra == nullptr) return;
      constexpr int kAt = Model::kPositionState;
      P(kAt, kAt) += deferred_.rest[0];
      P(kAt + 1, kAt) += deferred_.rest[1];
      P(kAt + 1, kAt + 1) += deferred_.rest[2];
      deferred_ = {};
      model.deferred_noise_absorbed();
    }
  }

  // Members, not locals, so that the stack stays small.
  T directions_[kMostRank][Model::kStates] = {};
  T correction_[Model::kStates] = {};
  DeferredNoise<T> deferred_;
  TiltAxes<T> axes_;
};

}  // namespace cairn::detail
