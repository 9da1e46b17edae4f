#include "cairn/tracking/reentry_rule.hpp"

namespace cairn {

void ReentryRule::move_on(float way_m, LandmarkId next) {
  way_m_ += way_m;
  if (way_m_ < kStep_m) return;
  way_m_ -= kStep_m;
  milestones_[oldest_milestone_] = next;
  oldest_milestone_ = (oldest_milestone_ + 1) % kMilestones;
}

bool ReentryRule::allows(LandmarkId id) const {
  if (id >= milestones_[oldest_milestone_] && id >= first_own_) return false;
  for (const LandmarkId refused : refused_) {
    if (refused == id) return false;
  }
  return true;
}

}  // namespace cairn
