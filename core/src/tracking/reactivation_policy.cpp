#include "cairn/tracking/reactivation_policy.hpp"

namespace cairn {

void ReactivationPolicy::travel(float distance_m, LandmarkId next) {
  travelled_m_ += distance_m;
  if (travelled_m_ < kStep_m) return;
  travelled_m_ -= kStep_m;
  milestones_[oldest_milestone_] = next;
  oldest_milestone_ = (oldest_milestone_ + 1) % kMilestones;
}

bool ReactivationPolicy::allows(LandmarkId id) const {
  if (id >= milestones_[oldest_milestone_] && id >= first_own_) return false;
  for (const LandmarkId refused : refused_) {
    if (refused == id) return false;
  }
  return true;
}

}  // namespace cairn
