#pragma once

#include "cairn/base/fixed_vector.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/tracking/appearance.hpp"
#include "cairn/tracking/floor_proof.hpp"

namespace cairn {

/// A landmark of the filter as the tracker knows it.
struct TrackedLandmark {
  LandmarkId id = kNoLandmark;
  Appearance appearance;
  int predicted = 0;  ///< frames in which it was searched
  int measured = 0;   ///< of these, frames in which the filter used it
  int misses = 0;     ///< searches since the filter used it last
  int frames_out_of_view = 0;
  bool searched = false;      ///< in the last frame
  bool from_library = false;  ///< reactivated from the map library
  bool stored = false;        ///< it is in the map library, or was sent there
  FloorTest floor = FloorTest::kOpen;
  bool in_ground_check = false;  ///< its height was noted
};

/// The tracker's records of the filter's landmarks, found by id. Cost of a look-up: Capacity
/// comparisons.
template <int Capacity>
class TrackedLandmarks {
 public:
  TrackedLandmark* find(LandmarkId id) {
    for (TrackedLandmark& entry : entries_) {
      if (entry.id == id) return &entry;
    }
    return nullptr;
  }
  const TrackedLandmark* find(LandmarkId id) const {
    for (const TrackedLandmark& entry : entries_) {
      if (entry.id == id) return &entry;
    }
    return nullptr;
  }
  bool add(const TrackedLandmark& landmark) { return entries_.push_back(landmark); }
  void remove(LandmarkId id) {
    for (int i = 0; i < entries_.size(); ++i) {
      if (entries_[i].id == id) {
        entries_.remove_unordered(i);
        return;
      }
    }
  }
  void clear() { entries_.clear(); }
  /// Feeds ids and descriptors to a hash.
  void hash(Hash64& hash) const {
    for (const TrackedLandmark& landmark : entries_) {
      hash.add(landmark.id);
      hash.add_bytes(landmark.appearance.descriptor.bytes, Descriptor::kBytes);
    }
  }
  int size() const { return entries_.size(); }
  TrackedLandmark* begin() { return entries_.begin(); }
  TrackedLandmark* end() { return entries_.end(); }
  const TrackedLandmark* begin() const { return entries_.begin(); }
  const TrackedLandmark* end() const { return entries_.end(); }

 private:
  FixedVector<TrackedLandmark, Capacity> entries_;
};

}  // namespace cairn
