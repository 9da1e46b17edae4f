#pragma once

#include "cairn/planar/types.hpp"

namespace cairn::detail {

/// What a new landmark refers to: where one of these would make room for it, the map is full.
struct NeededLandmarks {
  LandmarkId first = kNoLandmark;
  LandmarkId second = kNoLandmark;

  bool has(LandmarkId id) const { return id == first || id == second; }
};

/// Identities and statistics of the landmarks in a filter's state, by slot. Slots are dense: a
/// removal moves the last landmark into the gap.
template <int Capacity>
class LandmarkSlots {
 public:
  int size() const { return size_; }
  bool full() const { return size_ == Capacity; }
  LandmarkId id(int slot) const { return ids_[slot]; }
  LandmarkStatistics& statistics(int slot) { return statistics_[slot]; }
  const LandmarkStatistics& statistics(int slot) const { return statistics_[slot]; }

  int find(LandmarkId id) const {
    for (int slot = 0; slot < size_; ++slot) {
      if (ids_[slot] == id) return slot;
    }
    return -1;
  }

  void clear() { size_ = 0; }

  void push(LandmarkId id, std::uint32_t update) {
    ids_[size_] = id;
    statistics_[size_] = LandmarkStatistics{};
    statistics_[size_].measured = 1;
    statistics_[size_].last_measured = update;
    ++size_;
  }

  void remove_unordered(int slot) {
    --size_;
    ids_[slot] = ids_[size_];
    statistics_[slot] = statistics_[size_];
  }

  /// Slot to give up: unused for the largest number of updates, at least `least_age`; then used
  /// least; then the lowest. -1 when there is none.
  int replaceable(std::uint32_t update, std::uint32_t least_age) const {
    int best = -1;
    std::uint32_t best_age = 0;
    for (int slot = 0; slot < size_; ++slot) {
      const std::uint32_t age = update - statistics_[slot].last_measured;
      if (age < least_age || statistics_[slot].pinned) continue;
      const bool older = best < 0 || age > best_age;
      const bool rarer =
          best >= 0 && age == best_age && statistics_[slot].measured < statistics_[best].measured;
      if (older || rarer) {
        best = slot;
        best_age = age;
      }
    }
    return best;
  }

 private:
  LandmarkId ids_[Capacity] = {};
  LandmarkStatistics statistics_[Capacity] = {};
  int size_ = 0;
};

}  // namespace cairn::detail
