#pragma once

#include "cairn/base/health.hpp"
#include "cairn/mono/mono_state.hpp"

namespace cairn::mono {

/// Watches that P stays positive semi-definite and mends it where the rounding noise was not
/// enough: the last resort, counted (Health::covariance_repairs, Health::resets).
template <class T>
class CovarianceGuard {
 public:
  void reset() { *this = CovarianceGuard(); }
  /// An innovation covariance or a correction was impossible.
  void note_unsound() { unsound_ = true; }

  /// Looks at the variances of all states, and at the joint covariance of the camera and two
  /// features with their anchors for kPairs pairs, others each time: all of them in turn. Cost: n
  /// comparisons and at most 3000 multiply-adds for each pair.
  template <int N, class Features>
  void check(MonoState<T, N>& state, const Features& features, Health& health);

 private:
  template <int N, class Features>
  static bool features_sound(const MonoState<T, N>& state, const Features& features, int slot,
                             int other);
  template <int N>
  static void forget(MonoState<T, N>& state, Health& health);

  int next_check_ = 0;  ///< pair of features whose covariance is checked next
  bool unsound_ = false;
};

template <class T>
template <int N, class Features>
void CovarianceGuard<T>::check(MonoState<T, N>& state, const Features& features, Health& health) {
  constexpr int kPairs = 2;
  constexpr T kRepair = T(1.0 / 1024.0);  // of each variance
  bool sound = !unsound_ && variances_sound(state.covariance);
  unsound_ = false;
  for (int k = 0; k < kPairs && sound && features.size() > 0; ++k) {
    const int n = features.size();
    next_check_ = (next_check_ + 1) % (n * n);
    const int slot = next_check_ % n;
    const int other = next_check_ / n;
    if (features_sound(state, features, slot, other)) continue;
    ++health.covariance_repairs;
    state.covariance.inflate_diagonal(kRepair);
    sound = features_sound(state, features, slot, other);
  }
  if (!sound) forget(state, health);
}

template <class T>
template <int N, class Features>
bool CovarianceGuard<T>::features_sound(const MonoState<T, N>& state, const Features& features,
                                        int slot, int other) {
  int states[CameraBlock<T>::kMaxStates + 12];
  int count = 0;
  const auto take = [&](int at, int size) {
    for (int i = at; i < at + size; ++i) states[count++] = i;
  };
  const auto take_feature = [&](const auto& feature, int known_anchor) {
    if (feature.anchor >= 0 && feature.anchor != known_anchor) take(features.anchor_at(feature), 3);
    take(feature.at, state.layout().block);
  };
  take(0, state.layout().size);
  take_feature(features[slot], -1);
  if (other != slot) take_feature(features[other], features[slot].anchor);
  PackedSymmetric<T, CameraBlock<T>::kMaxStates + 12> joint;
  joint.resize(count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j <= i; ++j) joint(i, j) = state.covariance(states[i], states[j]);
  }
  return factor_semidefinite(joint);
}

template <class T>
template <int N>
void CovarianceGuard<T>::forget(MonoState<T, N>& state, Health& health) {
  forget_correlations(state.covariance);
  transform_block(state.covariance, state.layout().quaternion,
                  normalisation_jacobian<T>(state.quaternion()));
  state.inflate_attitude(state.attitude_variance());
  ++health.resets;
}

}  // namespace cairn::mono
