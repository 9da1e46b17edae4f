#pragma once

#include "cairn/estimation/observation.hpp"

namespace cairn {

/// Which landmarks of the map library may enter a vehicle's filter again: those archived before the
/// last 16 m of travel, because the filter still shares the error of newer ones, and not among the
/// last 32 landmarks that failed to match.
class ReactivationPolicy {
 public:
  void reset() { *this = ReactivationPolicy(); }
  /// Ids below `next` came with a saved library: all of them may enter.
  void allow_below(LandmarkId next) { first_own_ = next; }
  /// The vehicle travelled `distance_m` further; `next` is the first id not given out yet.
  void travel(float distance_m, LandmarkId next);
  /// The landmark was searched and failed to match.
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
  float travelled_m_ = 0.0F;                 ///< since the last milestone
  LandmarkId milestones_[kMilestones] = {};  ///< first id not given out when each was passed
  int oldest_milestone_ = 0;
  LandmarkId refused_[kRefused] = {};
  int next_refused_ = 0;
};

}  // namespace cairn
