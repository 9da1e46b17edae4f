#include "cairn/tracking/tracking_monitor.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {

bool TrackingMonitor::enough_matches(const MeasurementCounts& counts, bool thin) const {
  const bool returning = weak_frames_ >= 2;
  if (returning && thin) {
    return 2 * counts.matches >= counts.searched && counts.matches >= parameters_.min_inliers;
  }
  const float least = returning ? parameters_.min_return_ratio : parameters_.min_match_ratio;
  if (static_cast<float>(counts.matches) < least * static_cast<float>(counts.searched)) {
    return false;
  }
  const bool nearly_all =
      4 * counts.matches >= 3 * counts.searched && counts.matches >= parameters_.min_inliers;
  return !returning || nearly_all || counts.matches >= parameters_.min_return_matches;
}

/// Another place with the same texture (tiles, shelves) can agree with a fifth of the map. Fewer
/// inliers than half of what the running mean predicts are accepted only when they are nearly all
/// of the matches.
int TrackingMonitor::min_inliers(const MeasurementCounts& counts, int least) const {
  const float expected = mean_inlier_ratio_ * static_cast<float>(counts.searched);
  const int of_expected = round_to_int(parameters_.min_mean_ratio * expected);
  constexpr float kNearlyAll = 0.8F;
  const int of_matches = round_to_int(kNearlyAll * static_cast<float>(counts.matches));
  const int nearly_all =
      of_matches > parameters_.min_inliers ? of_matches : parameters_.min_inliers;
  const int wanted = of_expected < nearly_all ? of_expected : nearly_all;
  return wanted > least ? wanted : least;
}

/// Repeated texture matches anywhere, but at a wrong place few of the matches agree on a pose.
int TrackingMonitor::min_relocalisation_inliers(int found) const {
  const int most = (2 * found + 2) / 3;
  return most > parameters_.min_return_matches ? most : parameters_.min_return_matches;
}

bool TrackingMonitor::confirms_place(int found, int expected) const {
  return found >= parameters_.min_return_matches &&
         static_cast<float>(found) >= parameters_.min_place_ratio * static_cast<float>(expected);
}

NotTracked TrackingMonitor::why_not_tracked(const MeasurementCounts& counts,
                                            NotTracked shortage) const {
  if (holds(counts)) return NotTracked::kTracked;
  if (!counts.could_search) return NotTracked::kNoWork;
  if (counts.searched < parameters_.min_inliers) return shortage;
  const bool found = counts.matches >= parameters_.min_inliers && enough_matches(counts);
  return found ? NotTracked::kNoConsensus : NotTracked::kNotFound;
}

Status TrackingMonitor::judge(const MeasurementCounts& counts, Status status, Health& health) {
  if (holds(counts)) {
    weak_frames_ = 0;
    weak_s_ = 0.0F;
    if (probation_ > 0) --probation_;
    state_ = probation_ > 0 ? TrackingState::kUncertain : TrackingState::kTracking;
    update_mean(counts);
  } else if (state_ != TrackingState::kInitialising) {
    note_weak_frame(counts.could_search, health);
  }
  if (counts.searched > 0 && counts.matches < parameters_.min_inliers) {
    ++health.low_texture_frames;
    if (ok(status)) status = Status::kLowTexture;
  }
  return state_ == TrackingState::kLost ? Status::kLost : status;
}

/// A frame that could not search says nothing about the map.
void TrackingMonitor::note_weak_frame(bool could_search, Health& health) {
  if (could_search) {
    ++weak_frames_;
    weak_s_ += step_s_;
  }
  const bool refuted = probation_ > 0 && could_search;
  const bool lost = refuted || weak_s_ >= parameters_.uncertain_s_to_lost;
  if (lost && state_ != TrackingState::kLost) {
    ++(probation_ > 0 ? health.false_relocalisations_refused : health.losses);
    probation_ = 0;
  }
  state_ = lost ? TrackingState::kLost : TrackingState::kUncertain;
}

void TrackingMonitor::note_blind_frames(int frames) {
  constexpr int kMost = 1000;
  if (frames <= 0 || state_ == TrackingState::kInitialising) return;
  const int most = kMost - weak_frames_;
  if (most > 0) weak_frames_ += frames < most ? frames : most;
  const float left_s = parameters_.uncertain_s_to_lost - weak_s_;
  const float blind_s = static_cast<float>(frames) * step_s_;
  if (left_s > 0.0F) weak_s_ += blind_s < left_s ? blind_s : left_s;
  if (state_ == TrackingState::kTracking) state_ = TrackingState::kUncertain;
}

void TrackingMonitor::begin_probation() {
  weak_frames_ = 0;
  weak_s_ = 0.0F;
  probation_ = parameters_.probation_frames;
  state_ = TrackingState::kUncertain;
}

void TrackingMonitor::restart() {
  weak_frames_ = 0;
  weak_s_ = 0.0F;
  state_ = TrackingState::kInitialising;
}

void TrackingMonitor::lose() {
  weak_frames_ = 0;
  weak_s_ = 0.0F;
  probation_ = 0;
  state_ = TrackingState::kLost;
}

void TrackingMonitor::update_mean(const MeasurementCounts& counts) {
  constexpr float kGain = 0.1F;  // ten frames
  constexpr int kMinSearched = 8;
  if (counts.searched < kMinSearched) return;
  const float ratio = static_cast<float>(counts.inliers) / static_cast<float>(counts.searched);
  mean_inlier_ratio_ += kGain * (ratio - mean_inlier_ratio_);
}

}  // namespace cairn
