#pragma once

#include "cairn/estimation/observation.hpp"

namespace cairn {

/// Which landmarks of the map library a vehicle's filter may take back: those from before the last
/// 16 m of way, whose error the filter no longer shares, and none that was looked for in vain of
/// late.
class ReentryRule {
 public:
  void reset() { *this = ReentryRule(); }
  /// Ids below `next` came with a library from elsewhere: old from the start.
  void take_for_old(LandmarkId next) { first_own_ = next; }
  /// `way_m` more was made; `next` is the first id not given yet.
  void move_on(float way_m, LandmarkId next);
  void refuse(LandmarkId id) {
    refused_[next_refused_] = id;
    next_refused_ = (next_refused_ + 1) % kRefused;
  }
  /// Cost: at most 32 comparisons.
  bool allows(LandmarkId id) const;

 private:
  static constexpr float kStep_m = 2.0F;
  static constexpr int kMilestones = 8;
  static constexpr int kRefused = 32;

  LandmarkId first_own_ = 1;
  float way_m_ = 0.0F;                       ///< since the last milestone
  LandmarkId milestones_[kMilestones] = {};  ///< first id not given when each was passed
  int oldest_milestone_ = 0;
  LandmarkId refused_[kRefused] = {};
  int next_refused_ = 0;
};

}  // namespace cairn
