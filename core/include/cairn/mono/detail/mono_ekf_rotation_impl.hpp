#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

/// One axis after the other: the rate is measured, and the attitude follows by what the noise of
/// the step made common to both.
template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::observe_rotation(const Vector3<T>& rotation,
                                                             const Vector3<T>& sigma_rad, T dt_s) {
  if (!initialised_) return Status::kNotInitialised;
  bool finite = is_finite(dt_s);
  bool positive = dt_s > T(0);
  for (int k = 0; k < 3; ++k) {
    finite = finite && is_finite(rotation(k)) && is_finite(sigma_rad(k));
    positive = positive && sigma_rad(k) > T(0);
  }
  if (!finite) {
    ++health_.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (!positive) return Status::kInvalidArgument;
  const int n = covariance_.size();
  T delta[kMaxStates] = {};
  T* const gain = scratch_[0];
  covariance_.inflate_diagonal(kRoundingNoise<T>);
  for (int k = 0; k < 3; ++k) {
    const int w = layout_.rate + k;
    for (int i = 0; i < n; ++i) gain[i] = covariance_(i, w);
    const T s = (T(1) + kRoundingNoise<T>)*gain[w] + square(sigma_rad(k) / dt_s);
    const T step = (rotation(k) / dt_s - x_[w] - delta[w]) / s;
    for (int i = 0; i < n; ++i) delta[i] += gain[i] * step;
    covariance_.downdate(gain, T(1) / s);
  }
  correct_state(delta);
  guard_covariance();
  return Status::kOk;
}

}  // namespace cairn
