#pragma once

#include "cairn/mono/mono_ekf.hpp"

namespace cairn {

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::add_feature(LandmarkId id, const Vector2<T>& pixel) {
  T inverse_depth = first_inverse_depth_;
  T sigma = first_inverse_depth_sigma_;
  if (parameters_.depth_from_map) features_.expected_inverse_depth(state_, inverse_depth, sigma);
  return add_feature(id, pixel, inverse_depth, sigma);
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::add_feature(LandmarkId id, const Vector2<T>& pixel,
                                                        T inverse_depth, T sigma) {
  if (!initialised_) return Status::kNotInitialised;
  if (!is_finite(pixel.x()) || !is_finite(pixel.y())) {
    ++health_.non_finite_inputs;
    return Status::kNonFiniteInput;
  }
  if (id == kNoLandmark || !is_finite(inverse_depth) || !(inverse_depth > T(0)) ||
      !is_finite(sigma) || !(sigma > T(0))) {
    return Status::kInvalidArgument;
  }
  if (find(id) >= 0) return Status::kDuplicate;
  if (features_.full()) {
    ++health_.landmarks_refused;
    return Status::kFull;
  }
  if (!state_.camera.told().contains(pixel)) return Status::kOutOfView;
  const Status status = features_.add(state_, parameters_, id, pixel, inverse_depth, sigma);
  if (ok(status)) ++health_.landmarks_added;
  return status;
}

template <class T, int MaxFeatures, int MaxAnchors>
Status MonoEkf<T, MaxFeatures, MaxAnchors>::remove_feature(int slot) {
  if (slot < 0 || slot >= features_.size()) return Status::kInvalidArgument;
  features_.remove(state_, slot);
  ++health_.landmarks_removed;
  return Status::kOk;
}

template <class T, int MaxFeatures, int MaxAnchors>
int MonoEkf<T, MaxFeatures, MaxAnchors>::prune(const FeaturePolicy& policy, int room,
                                               LandmarkId* removed) {
  int count = 0;
  const auto remove = [&](int slot) {
    if (removed != nullptr) removed[count] = features_[slot].id;
    if (ok(remove_feature(slot))) ++count;
  };
  for (int slot = features_.size() - 1; slot >= 0; --slot) {
    const FeatureStatistics& s = features_[slot].statistics;
    const bool poor = s.predicted >= policy.min_predicted &&
                      static_cast<float>(s.measured) <
                          policy.min_measured_share * static_cast<float>(s.predicted);
    if (poor || s.out_of_view > policy.max_out_of_view) remove(slot);
  }
  const int wanted = room < MaxFeatures ? room : MaxFeatures;
  for (int k = 0; k < MaxFeatures && MaxFeatures - features_.size() < wanted; ++k) {
    int worst = -1;
    int longest = 0;
    for (int slot = 0; slot < features_.size(); ++slot) {
      if (features_[slot].statistics.out_of_view <= longest) continue;
      longest = features_[slot].statistics.out_of_view;
      worst = slot;
    }
    if (worst < 0) break;
    remove(worst);
  }
  return count;
}

template <class T, int MaxFeatures, int MaxAnchors>
void MonoEkf<T, MaxFeatures, MaxAnchors>::hash(Hash64& hash) const {
  const int n = state_.size();
  hash.add(static_cast<std::int32_t>(n));
  for (int i = 0; i < n; ++i) hash.add(state_.x[i]);
  const int elements = n * (n + 1) / 2;
  for (int i = 0; i < elements; ++i) hash.add(state_.covariance.data()[i]);
  features_.hash(hash);
}

}  // namespace cairn
