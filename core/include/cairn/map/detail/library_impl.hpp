#pragma once

#include "cairn/map/library.hpp"

namespace cairn {
namespace detail {

template <class T>
Status validate_view(const LandmarkView<T>& view, const Vector3<T>& p_map) {
  const Rigid<T>& pose = view.T_map_reference;
  if (!is_finite(view.focal_px + pose.translation.sum() + pose.rotation.coeffs().sum())) {
    return Status::kNonFiniteInput;
  }
  const T excess = pose.rotation.squaredNorm() - T(1);
  const bool is_rotation = excess > T(-1e-2) && excess < T(1e-2);
  const T distance_squared = (pose.translation - p_map).squaredNorm();
  if (!is_rotation || !(view.focal_px > T(0)) ||
      !(distance_squared >= square(PinholeCamera<T>::kMinDepth)) ||
      view.pose.scale_index > kMaxFreakScaleIndex) {
    return Status::kInvalidArgument;
  }
  return Status::kOk;
}

/// Distance at which a landmark was described.
template <class T, int Views>
T described_from(const LibraryLandmark<T, Views>& landmark) {
  return sqrt((landmark.views[0].T_map_reference.translation - landmark.p_map).squaredNorm());
}

}  // namespace detail

template <class Config, int Views>
Status MapLibrary<Config, Views>::validate(const Landmark& landmark) {
  if (!is_finite(landmark.p_map.sum() + landmark.covariance.sum())) {
    return Status::kNonFiniteInput;
  }
  if (landmark.id == kNoLandmark || landmark.view_count < 1 || landmark.view_count > Views ||
      landmark.sightings > landmark.searches) {
    return Status::kInvalidArgument;
  }
  for (int k = 0; k < 3; ++k) {
    if (!(landmark.covariance(k, k) >= Scalar(0))) return Status::kInvalidArgument;
  }
  for (int v = 0; v < landmark.view_count; ++v) {
    const Status status = detail::validate_view(landmark.views[v], landmark.p_map);
    if (!ok(status)) return status;
  }
  return Status::kOk;
}

template <class Config, int Views>
bool MapLibrary<Config, Views>::are_neighbours(const Landmark& a, const Landmark& b) {
  const Scalar reach = Scalar(0.025) * (detail::described_from(a) + detail::described_from(b));
  return (a.p_map - b.p_map).squaredNorm() < reach * reach;
}

template <class Config, int Views>
int MapLibrary<Config, Views>::count_neighbours(const Landmark& landmark, int except_slot) const {
  int count = 0;
  for (int slot = 0; slot < size(); ++slot) {
    if (slot != except_slot && are_neighbours(landmark, landmarks_[slot])) ++count;
  }
  return count;
}

template <class Config, int Views>
void MapLibrary<Config, Views>::add_to_neighbours(const Landmark& landmark, int except_slot,
                                                  int change) {
  for (int slot = 0; slot < size(); ++slot) {
    if (slot != except_slot && are_neighbours(landmark, landmarks_[slot])) {
      neighbours_[slot] = static_cast<std::uint16_t>(neighbours_[slot] + change);
    }
  }
}

template <class Config, int Views>
void MapLibrary<Config, Views>::place(int slot, const Landmark& landmark) {
  landmarks_[slot] = landmark;
  neighbours_[slot] = static_cast<std::uint16_t>(count_neighbours(landmark, slot));
  score_[slot] = static_cast<std::uint16_t>(landmark_score(landmark));
  add_to_neighbours(landmark, slot, 1);
  ++revision_;
}

/// Whether the landmark in `slot` is replaced before another with the given retention score.
template <class Config, int Views>
bool MapLibrary<Config, Views>::gives_way(int slot, int other_score, const Landmark& other) const {
  const int own = retention_score(slot);
  if (own != other_score) return own < other_score;
  const Landmark& landmark = landmarks_[slot];
  if (landmark.sightings != other.sightings) return landmark.sightings < other.sightings;
  return landmark.id > other.id;
}

template <class Config, int Views>
int MapLibrary<Config, Views>::weakest_slot() const {
  int least = 0;
  for (int slot = 1; slot < size(); ++slot) {
    if (gives_way(slot, retention_score(least), landmarks_[least])) least = slot;
  }
  return least;
}

template <class Config, int Views>
Status MapLibrary<Config, Views>::insert(const Landmark& landmark, Health& health) {
  const Status status = validate(landmark);
  if (!ok(status)) return status;
  if (find(landmark.id) >= 0) return Status::kDuplicate;
  if (!landmarks_.full()) {
    landmarks_.push_back(landmark);
    place(size() - 1, landmark);
    ++health.landmarks_added;
    return Status::kOk;
  }
  const int slot = weakest_slot();
  // The new landmark's score once the one that it replaces no longer counts as a neighbour.
  const int retention_score =
      retention_of(landmark_score(landmark), count_neighbours(landmark, slot));
  if (!gives_way(slot, retention_score, landmark)) {
    ++health.landmarks_refused;
    return Status::kFull;
  }
  const Landmark leaving = landmarks_[slot];
  add_to_neighbours(leaving, slot, -1);
  place(slot, landmark);
  ++health.landmarks_replaced;
  return Status::kOk;
}

template <class Config, int Views>
Status MapLibrary<Config, Views>::update(const Landmark& landmark) {
  const Status status = validate(landmark);
  if (!ok(status)) return status;
  const int slot = find(landmark.id);
  if (slot < 0) return Status::kNotFound;
  const Landmark before = landmarks_[slot];
  add_to_neighbours(before, slot, -1);
  place(slot, landmark);
  return Status::kOk;
}

template <class Config, int Views>
Status MapLibrary<Config, Views>::remove(LandmarkId id) {
  const int slot = find(id);
  if (slot < 0) return Status::kNotFound;
  const Landmark leaving = landmarks_[slot];
  add_to_neighbours(leaving, slot, -1);
  const int last = size() - 1;
  neighbours_[slot] = neighbours_[last];
  score_[slot] = score_[last];
  landmarks_.remove_unordered(slot);
  ++revision_;
  return Status::kOk;
}

template <class Config, int Views>
Status MapLibrary<Config, Views>::record(LandmarkId id, bool seen) {
  const int slot = find(id);
  if (slot < 0) return Status::kNotFound;
  landmarks_[slot].record(seen);
  score_[slot] = static_cast<std::uint16_t>(landmark_score(landmarks_[slot]));
  ++revision_;
  return Status::kOk;
}

}  // namespace cairn
