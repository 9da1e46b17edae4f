#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

/// Noise for what F P F^T has rounded, by the size of its terms: of the sum, and of what the
/// velocities bring.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::add_rounding_noise(T dt_s) {
  const T squared = dt_s * dt_s;
  T turned = attitude_variance();
  for (int i = 0; i < 3; ++i) {
    const int w = layout_.rate + i;
    turned += squared * covariance_.row(w)[w];
    if (layout_.position < 0) continue;
    const int v = layout_.velocity + i;
    T& position = covariance_.row(layout_.position + i)[layout_.position + i];
    position += kRoundingNoise<T> * (position + squared * covariance_.row(v)[v]);
  }
  inflate_attitude(turned);
}

template <class T, int MaxFeatures, int MaxAnchors>
T MonoEkf<T, MaxFeatures, MaxAnchors>::attitude_variance() const {
  T sum = T(0);
  for (int i = layout_.quaternion; i < layout_.quaternion + 4; ++i) sum += covariance_.row(i)[i];
  return sum;
}

/// Noise for a linear map of the quaternion's errors, whose terms are of the size of `variance`. A
/// quaternion has no error along itself, where noise in shares of its own variance would be none.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::inflate_attitude(T variance) {
  for (int i = layout_.quaternion; i < layout_.quaternion + 4; ++i) {
    covariance_.row(i)[i] += kRoundingNoise<T> * variance;
  }
}

/// Watches that P stays positive semi-definite and mends it where the rounding noise was not
/// enough: the last resort, counted. Looks at the variances of all states, and at the joint
/// covariance of the camera and two features with their anchors for kPairs pairs, others each time:
/// all of them in turn. Cost: n comparisons and at most 3000 multiply-adds for each pair.
template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::guard_covariance() {
  constexpr int kPairs = 2;
  constexpr T kRepair = T(1.0 / 1024.0);  // of each variance
  bool sound = !unsound_ && variances_sound(covariance_);
  unsound_ = false;
  for (int k = 0; k < kPairs && sound && feature_count_ > 0; ++k) {
    const int n = feature_count_;
    next_check_ = (next_check_ + 1) % (n * n);
    const int slot = next_check_ % n;
    const int other = next_check_ / n;
    if (features_sound(slot, other)) continue;
    ++health_.covariance_repairs;
    covariance_.inflate_diagonal(kRepair);
    sound = features_sound(slot, other);
  }
  if (!sound) forget_correlations();
}

template <class T, int MaxFeatures, int MaxAnchors>
bool MonoEkf<T, MaxFeatures, MaxAnchors>::features_sound(int slot, int other) const {
  int states[kMaxCameraStates + 12];
  int count = 0;
  const auto take = [&](int at, int size) {
    for (int i = at; i < at + size; ++i) states[count++] = i;
  };
  const auto take_feature = [&](const Feature& feature, int known_anchor) {
    if (feature.anchor >= 0 && feature.anchor != known_anchor) take(anchors_[feature.anchor].at, 3);
    take(feature.at, layout_.block);
  };
  take(0, layout_.size);
  take_feature(features_[slot], -1);
  if (other != slot) take_feature(features_[other], features_[slot].anchor);
  PackedSymmetric<T, kMaxCameraStates + 12> joint;
  joint.resize(count);
  for (int i = 0; i < count; ++i) {
    for (int j = 0; j <= i; ++j) joint(i, j) = covariance_(states[i], states[j]);
  }
  return factor_semidefinite(joint);
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::forget_correlations() {
  cairn::forget_correlations(covariance_);
  mono::transform_block(covariance_, layout_.quaternion,
                        mono::normalisation_jacobian<T>(quaternion_at(x_)));
  inflate_attitude(attitude_variance());
  ++health_.resets;
}

}  // namespace cairn
