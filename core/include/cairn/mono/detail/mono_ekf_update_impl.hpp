#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::check_matches(const PixelMatch<T>* matches,
                                                          int count) const {
  if (count < 0 || count > features_.size() || (count > 0 && matches == nullptr)) {
    return Status::kInvalidArgument;
  }
  bool seen[MaxFeatures] = {};
  for (int i = 0; i < count; ++i) {
    const int slot = matches[i].slot;
    if (slot < 0 || slot >= features_.size() || features_[slot].id != matches[i].id || seen[slot]) {
      return Status::kInvalidArgument;
    }
    seen[slot] = true;
    if (!is_finite(matches[i].pixel.x()) || !is_finite(matches[i].pixel.y())) {
      return Status::kNonFiniteInput;
    }
  }
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::count_visibility() {
  for (int slot = 0; slot < features_.size(); ++slot) {
    FeatureStatistics& statistics = features_[slot].statistics;
    Vector2<T> pixel;
    if (ok(features_.pixel_at(state_, state_.x, slot, pixel)) &&
        state_.camera.told().contains(pixel)) {
      ++statistics.predicted;
      ++statistics.consecutive_misses;  // 0 again where the measurement is used
      statistics.out_of_view = 0;
    } else {
      ++statistics.out_of_view;
    }
  }
}

/// State of the hypothesis x + P H_i' S_i^-1 nu_i of one match, and who agrees with it: Civera et
/// al. 2010, algorithm 1. Only the state moves, not P.
template <class T, int MaxFeatures, int MaxAnchors>
int MonoEkf<T, MaxFeatures, MaxAnchors>::evaluate_hypothesis(const PixelMatch<T>* matches,
                                                             int count, int candidate,
                                                             bool* inliers) const {
  const PixelMatch<T>& match = matches[candidate];
  Vector2<T> pixel;
  Rows2 rows;
  if (!ok(features_.linearise(state_, parameters_, match.slot, pixel, rows))) return 0;
  T gain[2][kMaxStates];
  mono::multiply(rows, state_.covariance, gain);
  const T variance = square(parameters_.sigma_px);
  T ia = T(0), ib = T(0), ic = T(0);
  if (!invert_spd2(rows.dot(0, gain[0]) + variance, rows.dot(1, gain[0]),
                   rows.dot(1, gain[1]) + variance, ia, ib, ic)) {
    return 0;
  }
  const Vector2<T> nu = match.pixel - pixel;
  const T g0 = ia * nu.x() + ib * nu.y();
  const T g1 = ib * nu.x() + ic * nu.y();
  T x[kMaxStates];
  for (int i = 0; i < state_.size(); ++i) x[i] = state_.x[i] + (gain[0][i] * g0 + gain[1][i] * g1);
  return mark_inliers(x, matches, count, inliers);
}

/// The same of three matches, one after the other on the parts of P that are left.
template <class T, int MaxFeatures, int MaxAnchors>
int MonoEkf<T, MaxFeatures, MaxAnchors>::evaluate_triple(const PixelMatch<T>* matches, int count,
                                                         const int* candidates, bool* inliers) {
  static_assert(kPendingPairs >= 3, "the scratch holds three gains");
  T x[kMaxStates] = {};
  for (int k = 0; k < 3; ++k) {
    T nis = T(0);
    if (fuse(matches[candidates[k]], k, x, nis) != Fusion::kDone) return 0;
  }
  for (int i = 0; i < state_.size(); ++i) x[i] += state_.x[i];
  return mark_inliers(x, matches, count, inliers);
}

/// Normalises the quaternion of x, and marks and counts the matches that fit the state x.
template <class T, int MaxFeatures, int MaxAnchors>
int MonoEkf<T, MaxFeatures, MaxAnchors>::mark_inliers(T* x, const PixelMatch<T>* matches, int count,
                                                      bool* inliers) const {
  const Vector<T, 4> q = state_.camera.quaternion(x);
  const T norm = sqrt(q.dot(q));
  if (!(norm > T(0.1))) return 0;
  for (int i = 0; i < 4; ++i) x[layout().quaternion + i] /= norm;

  const T limit = parameters_.inlier_gate * square(parameters_.sigma_px);
  int inlier_count = 0;
  for (int j = 0; j < count; ++j) {
    Vector2<T> expected;
    if (!ok(features_.pixel_at(state_, x, matches[j].slot, expected))) continue;
    const Vector2<T> difference = matches[j].pixel - expected;
    if (!(difference.dot(difference) < limit)) continue;
    inliers[j] = true;
    ++inlier_count;
  }
  return inlier_count;
}

/// Fades by what the low-innovation inliers show to be missing.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::adapt_memory(const PixelMatch<T>* matches, int count,
                                                       const bool* use) {
  typename mono::FadingMemory<T>::Residuals residuals;
  for (int i = 0; i < count; ++i) {
    Vector2<T> pixel;
    Rows2 rows;
    if (!use[i] || !ok(features_.linearise(state_, parameters_, matches[i].slot, pixel, rows))) {
      continue;
    }
    const Vector2<T> nu = matches[i].pixel - pixel;
    const Matrix2<T> whole = mono::quadratic(rows, state_.covariance);
    const Matrix2<T> driven = mono::quadratic(rows, 1, motion_.noise());  // run 0: camera block
    residuals.nu_squared += nu.dot(nu);
    residuals.driven += driven(0, 0) + driven(1, 1);
    residuals.whole += whole(0, 0) + whole(1, 1);
    ++residuals.used;
  }
  if (residuals.used > 0) fade(memory_.factor_for(residuals, parameters_), true);
}

/// One match of an update, linearised at x: adds its correction to `delta` and leaves its whitened
/// gain in row 2 * pairs of the scratch, whose rows before are still to be subtracted from P.
/// Otherwise, with nothing added: it cannot be projected, or S is not positive definite. What S
/// cannot resolve counts as measurement noise.
template <class T, int MaxFeatures, int MaxAnchors>
typename MonoEkf<T, MaxFeatures, MaxAnchors>::Fusion MonoEkf<T, MaxFeatures, MaxAnchors>::fuse(
    const PixelMatch<T>& match, int pairs, T* delta, T& nis) {
  const T variance = square(parameters_.sigma_px);
  const int n = state_.size();
  Vector2<T> pixel;
  Rows2 rows;
  if (!ok(features_.linearise(state_, parameters_, match.slot, pixel, rows)))
    return Fusion::kOutOfView;
  T(*const gain)[kMaxStates] = state_.scratch + 2 * pairs;
  mono::multiply(rows, state_.covariance, gain);
  for (int k = 0; k < pairs; ++k) mono::subtract_pending(rows, state_.scratch + 2 * k, n, gain);
  const T nu0 = match.pixel.x() - pixel.x() - rows.dot(0, delta);
  const T nu1 = match.pixel.y() - pixel.y() - rows.dot(1, delta);
  const T s00 = rows.dot(0, gain[0]) + variance + mono::rounding_noise(rows, 0, state_.covariance);
  const T s10 = rows.dot(1, gain[0]);
  const T s11 = rows.dot(1, gain[1]) + variance + mono::rounding_noise(rows, 1, state_.covariance);
  // gain <- L^-1 gain with S = L L^T, so that K nu = gain^T (L^-1 nu).
  const T l00 = s00 > T(0) ? T(1) / sqrt(s00) : T(0);
  const T l10 = s10 * l00;
  const T rest = s11 - l10 * l10;
  if (!(s00 > T(0)) || !(rest > T(0))) return Fusion::kSingular;
  const T l11 = T(1) / sqrt(rest);
  const T g0 = nu0 * l00;
  const T g1 = (nu1 - l10 * g0) * l11;
  for (int i = 0; i < n; ++i) {
    gain[0][i] *= l00;
    gain[1][i] = (gain[1][i] - l10 * gain[0][i]) * l11;
    delta[i] += gain[0][i] * g0 + gain[1][i] * g1;
  }
  nis = g0 * g0 + g1 * g1;
  return Fusion::kDone;
}

/// Update with the chosen matches, all linearised at the same x: equal to the batch update with H
/// stacked. One match after the other, with the innovation corrected by H dx and the gain by the
/// part of P that is still to be subtracted, which happens for kPendingPairs matches at once.
/// Returns the number used and marks them as inliers; one whose S is not positive definite is left
/// out.
template <class T, int MaxFeatures, int MaxAnchors>
int MonoEkf<T, MaxFeatures, MaxAnchors>::apply(PixelMatch<T>* matches, int count, const bool* use,
                                               UpdateReport& report) {
  T delta[kMaxStates] = {};
  int pairs = 0;
  int used = 0;
  state_.covariance.inflate_diagonal(kRoundingNoise<T>);
  for (int m = 0; m < count; ++m) {
    T nis = T(0);
    const Fusion fusion = use[m] ? fuse(matches[m], pairs, delta, nis) : Fusion::kOutOfView;
    if (fusion == Fusion::kSingular) {
      ++health_.innovations_singular;
      guard_.note_unsound();
    }
    if (fusion != Fusion::kDone) continue;
    report.nis += static_cast<float>(nis);
    report.nis_dof += 2;
    matches[m].inlier = true;
    ++used;
    if (++pairs == kPendingPairs) {
      state_.covariance.template downdate<2 * kPendingPairs, kMaxStates>(state_.scratch[0]);
      pairs = 0;
    }
  }
  for (int k = 0; k < pairs; ++k) {
    state_.covariance.template downdate<2, kMaxStates>(state_.scratch[2 * k]);
  }
  if (used > 0) correct_state(delta);
  return used;
}

/// x <- x + delta; then |q| = 1 (P by the Jacobian of the normalisation), inverse depths positive,
/// focal length possible. A delta that is not finite changes nothing.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::correct_state(const T* delta) {
  bool finite = true;
  for (int i = 0; i < state_.size(); ++i) finite = finite && is_finite(state_.x[i] + delta[i]);
  if (!finite) {
    guard_.note_unsound();
    return;
  }
  for (int i = 0; i < state_.size(); ++i) state_.x[i] += delta[i];
  const Vector<T, 4> q = state_.quaternion();
  const T norm = sqrt(q.dot(q));
  if (norm > T(0.1)) {
    const T before = state_.attitude_variance() / (norm * norm);
    mono::transform_block(state_.covariance, layout().quaternion,
                          mono::normalisation_jacobian<T>(q));
    state_.inflate_attitude(before);
    for (int i = 0; i < 4; ++i) state_.x[layout().quaternion + i] = q(i) / norm;
  } else {
    for (int i = 0; i < 4; ++i) state_.x[layout().quaternion + i] = i == 0 ? T(1) : T(0);
    ++health_.resets;
  }
  for (int i = 0; i < features_.size(); ++i) {
    if (features_[i].kind != FeatureKind::kInverseDepth) continue;
    T& rho = state_.x[features_[i].at + 2];
    if (rho >= parameters_.min_inverse_depth) continue;
    rho = parameters_.min_inverse_depth;
    ++health_.depth_repairs;
  }
  if (layout().focal >= 0)
    state_.x[layout().focal] = clamp(state_.x[layout().focal], T(-0.5), T(1));
}

/// Matches that the first update left out and that fit the updated state: nu' S^-1 nu below the
/// gate, S with R in it.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::rescue(const PixelMatch<T>* matches, int count,
                                                 bool* rescued) const {
  const T variance = square(parameters_.sigma_px);
  for (int i = 0; i < count; ++i) {
    rescued[i] = false;
    Vector2<T> pixel;
    Rows2 rows;
    if (matches[i].inlier ||
        !ok(features_.linearise(state_, parameters_, matches[i].slot, pixel, rows)))
      continue;
    const Matrix2<T> s = mono::quadratic(rows, state_.covariance);
    T ia = T(0), ib = T(0), ic = T(0);
    if (!invert_spd2(s(0, 0) + variance, s(0, 1), s(1, 1) + variance, ia, ib, ic)) continue;
    const Vector2<T> nu = matches[i].pixel - pixel;
    const T distance = ia * nu.x() * nu.x() + T(2) * ib * nu.x() * nu.y() + ic * nu.y() * nu.y();
    rescued[i] = distance < parameters_.rescue_gate;
  }
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::update(PixelMatch<T>* matches, int count,
                                                   Random& random, UpdateReport& report) {
  if (!initialised_) return Status::kNotInitialised;
  const Status status = check_matches(matches, count);
  if (!ok(status)) {
    if (status == Status::kNonFiniteInput) ++health_.non_finite_inputs;
    return status;
  }
  count_visibility();
  report = UpdateReport{};
  report.matches = count;
  for (int i = 0; i < count; ++i) matches[i].inlier = false;
  const auto evaluate = [&](int candidate, bool* inliers) {
    return evaluate_hypothesis(matches, count, candidate, inliers);
  };
  OnePointRansacResult<MaxFeatures> best =
      one_point_ransac<MaxFeatures>(count, parameters_.ransac, random, evaluate);
  if (static_cast<T>(best.inlier_count) < parameters_.enough_inlier_share * static_cast<T>(count)) {
    const auto evaluate_three = [&](const int* candidates, bool* inliers) {
      return evaluate_triple(matches, count, candidates, inliers);
    };
    const int most =
        triple_limit_ < parameters_.max_triples ? triple_limit_ : parameters_.max_triples;
    three_point_ransac(count, parameters_.ransac, most, random, evaluate_three, best);
  }
  report.hypotheses = best.hypotheses;
  report.triples = best.triples;
  if (!best.consensus) {
    if (count > 0) ++health_.ransac_no_consensus;
    return Status::kNoConsensus;
  }
  if (parameters_.fading == FadingMode::kAdaptive) adapt_memory(matches, count, best.inliers);
  report.low_innovation = apply(matches, count, best.inliers, report);
  bool rescued[MaxFeatures];
  rescue(matches, count, rescued);
  report.high_innovation = apply(matches, count, rescued, report);
  report.gated = count - report.low_innovation - report.high_innovation;

  for (int i = 0; i < count; ++i) {
    if (!matches[i].inlier) continue;
    FeatureStatistics& statistics = features_[matches[i].slot].statistics;
    ++statistics.measured;
    statistics.consecutive_misses = 0;
  }
  health_.innovations_used += static_cast<std::uint32_t>(count - report.gated);
  health_.innovations_gated += static_cast<std::uint32_t>(report.gated);
  guard_.check(state_, features_, health_);
  if (layout().lever >= 0)
    features_.leave_anchor();  // (R - I) lever is an anchor to first order only
  features_.convert_linear_features(state_, parameters_);
  return Status::kOk;
}

}  // namespace cairn
