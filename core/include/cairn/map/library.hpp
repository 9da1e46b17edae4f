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

  /// Removes a landmark by moving the last one into its slot. kNotFound.
  Status remove(LandmarkId id);

  /// Counts a search for a landmark, and whether it was found. kNotFound.
  Status record(LandmarkId id, bool seen);

  void clear() {
    landmarks_.clear();
    ++revision_;
  }

  /// kNonFiniteInput for NaN or infinity; kInvalidArgument for id 0, a view count outside 1 ..
  /// Views, a focal length that is not positive, a negative variance, a reference rotation that is
  /// not a unit quaternion, a reference camera at the landmark, or more sightings than searches.
  static Status validate(const Landmark& landmark);

 private:
  static constexpr int kScoreUnit = 16;

  static int retention_of(int score, int neighbours) {
    return score * kScoreUnit / (1 + neighbours);
  }
  static bool are_neighbours(const Landmark& a, const Landmark& b);
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

}  // namespace cairn

#include "cairn/map/detail/library_impl.hpp"
