#pragma once

#include <cstdint>

#include "cairn/base/config.hpp"
#include "cairn/base/fixed_vector.hpp"
#include "cairn/base/health.hpp"
#include "cairn/map/landmark.hpp"

namespace cairn {

/// Bounded library of archived landmarks, all storage inside.
///
/// Admission and replacement. A landmark's retention score is its own score (landmark_score)
/// divided by one plus the number of its neighbours, so that crowded places lose landmarks first.
/// Two landmarks are neighbours when they are nearer to each other than 5 % of the mean distance
/// from which they were described. When the library is full, a new landmark replaces the one with
/// the lowest retention score if its own is higher, and is refused otherwise. Ties: the one with
/// fewer sightings is replaced, then the one with the higher id. Slots never decide, so the result
/// does not depend on the order in which landmarks came.
template <class Config, int Views = 1>
class MapLibrary {
 public:
  using Scalar = typename Config::Scalar;
  using Landmark = LibraryLandmark<Scalar, Views>;
  static constexpr int kCapacity = Config::kLibraryLandmarks;
  static constexpr int kViews = Views;
  static_assert(kCapacity > 0 && kCapacity <= 4096, "slots are searched linearly");
  static_assert(Views >= 1 && Views <= 8, "views a landmark");

  int size() const { return landmarks_.size(); }
  bool empty() const { return landmarks_.empty(); }
  const Landmark& operator[](int slot) const { return landmarks_[slot]; }
  /// landmark_score() / (1 + neighbours), times 16 so that rounding keeps the order.
  int retention_score(int slot) const { return retention_of(score_[slot], neighbours_[slot]); }
  int neighbours(int slot) const { return neighbours_[slot]; }

  /// Counts every change of the content; equal revisions of one library mean equal content.
  std::uint32_t revision() const { return revision_; }

  /// Slot of `id`, -1 when absent. Cost: one pass.
  int find(LandmarkId id) const {
    for (int slot = 0; slot < size(); ++slot) {
      if (landmarks_[slot].id == id) return slot;
    }
    return -1;
  }

  /// Adds a landmark; a full library replaces the one with the lowest retention score.
  /// kDuplicate: the id is in the library (see update). kFull: none has a lower score.
  /// kNonFiniteInput, kInvalidArgument: see validate(). Cost: two passes over the library.
  Status insert(const Landmark& landmark, Health& health);

  /// Overwrites the landmark of the same id. kNotFound, or as insert. Cost: three passes.
  Status update(const Landmark& landmark);

  /// Counts a search for a landmark, and whether it was found. kNotFound.
  Status record(LandmarkId id, bool seen);

  void clear() {
    landmarks_.clear();
    ++revision_;
  }

  /// kNonFiniteInput for NaN or infinity; kInvalidArgument for id 0, a view count outside 1 to
  /// Views, a focal length that is not positive, a negative variance, a reference rotation that is
  /// not a unit quaternion, a reference camera at the landmark, or more sightings than searches.
  static Status validate(const Landmark& landmark);

 private:
  static constexpr int kScoreUnit = 16;

  static int retention_of(int score, int neighbours) {
    return score * kScoreUnit / (1 + neighbours);
  }
  template <class Visit>
  void visit_neighbours(const Landmark& landmark, int except_slot, const Visit& visit) const;
  int count_neighbours(const Landmark& landmark, int except_slot) const;
  void add_to_neighbours(const Landmark& landmark, int except_slot, int change);
  void place(int slot, const Landmark& landmark);
  bool gives_way(int slot, int retention_score, const Landmark& landmark) const;
  int weakest_slot() const;

  FixedVector<Landmark, kCapacity> landmarks_;
  std::uint16_t neighbours_[kCapacity] = {};
  std::uint16_t score_[kCapacity] = {};
  std::uint32_t revision_ = 0;
};

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

/// visit(slot) for each landmark beside another.
template <class Config, int Views>
template <class Visit>
void MapLibrary<Config, Views>::visit_neighbours(const Landmark& landmark, int except_slot,
                                                 const Visit& visit) const {
  const Scalar distance = detail::described_from(landmark);
  for (int slot = 0; slot < size(); ++slot) {
    if (slot == except_slot) continue;
    const Landmark& other = landmarks_[slot];
    const Scalar reach = Scalar(0.025) * (distance + detail::described_from(other));
    if ((landmark.p_map - other.p_map).squaredNorm() < reach * reach) visit(slot);
  }
}

template <class Config, int Views>
int MapLibrary<Config, Views>::count_neighbours(const Landmark& landmark, int except_slot) const {
  int count = 0;
  visit_neighbours(landmark, except_slot, [&](int /*slot*/) { ++count; });
  return count;
}

template <class Config, int Views>
void MapLibrary<Config, Views>::add_to_neighbours(const Landmark& landmark, int except_slot,
                                                  int change) {
  visit_neighbours(landmark, except_slot, [&](int slot) {
    neighbours_[slot] = static_cast<std::uint16_t>(neighbours_[slot] + change);
  });
}

template <class Config, int Views>
void MapLibrary<Config, Views>::place(int slot, const Landmark& landmark) {
  landmarks_[slot] = landmark;
  neighbours_[slot] = 0;
  visit_neighbours(landmark, slot, [&](int neighbour) {
    ++neighbours_[slot];
    ++neighbours_[neighbour];
  });
  score_[slot] = static_cast<std::uint16_t>(landmark_score(landmark));
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
  const int score = retention_of(landmark_score(landmark), count_neighbours(landmark, slot));
  if (!gives_way(slot, score, landmark)) {
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
Status MapLibrary<Config, Views>::record(LandmarkId id, bool seen) {
  const int slot = find(id);
  if (slot < 0) return Status::kNotFound;
  landmarks_[slot].record(seen);
  score_[slot] = static_cast<std::uint16_t>(landmark_score(landmarks_[slot]));
  ++revision_;
  return Status::kOk;
}

}  // namespace cairn
