#include "cairn/tracking/tracking_evidence.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {

bool TrackingEvidence::worth_an_update(const FrameReport& report, int matches) const {
  // After blind frames the windows have grown, and with them what is found by chance.
  const bool returning = weak_frames_ >= 2;
  const float least = returning ? parameters_.min_return_share : parameters_.min_match_share;
  if (static_cast<float>(matches) < least * static_cast<float>(report.searched)) return false;
  return !returning || matches >= parameters_.min_return_matches;
}

/// Another place of the same kind (tiles, shelves) can agree with a fifth of the map. Where far
/// fewer landmarks agree than did of late, and not nearly all of those found, the camera shows
/// something else.
int TrackingEvidence::support_wanted(const FrameReport& report, int least) const {
  const float usual = usual_share_ * static_cast<float>(report.searched);
  const int of_usual = round_to_int(parameters_.min_usual_share * usual);
  constexpr float kNearlyAll = 0.8F;
  const int of_found = round_to_int(kNearlyAll * static_cast<float>(report.matches));
  const int nearly_all = of_found > parameters_.min_inliers ? of_found : parameters_.min_inliers;
  const int wanted = of_usual < nearly_all ? of_usual : nearly_all;
  return wanted > least ? wanted : least;
}

/// Tiles and shelves are found anywhere, but at a wrong place few of them agree.
int TrackingEvidence::support_of_place(int found) const {
  const int most = (2 * found + 2) / 3;
  return most > parameters_.min_return_matches ? most : parameters_.min_return_matches;
}

bool TrackingEvidence::tells_place(int found, int expected) const {
  return found >= parameters_.min_return_matches &&
         static_cast<float>(found) >= parameters_.min_library_share * static_cast<float>(expected);
}

void TrackingEvidence::judge(FrameReport& report, Health& health) {
  if (consistent(report)) {
    weak_frames_ = 0;
    state_ = TrackingState::kTracking;
    note_usual(report);
  } else if (state_ != TrackingState::kInitialising) {
    // A frame that did not look tells nothing of the map.
    if (report.cut != FrameCut::kPredictionOnly) ++weak_frames_;
    const bool lost = weak_frames_ > parameters_.uncertain_frames_to_lost;
    if (lost && state_ != TrackingState::kLost) ++health.losses;
    state_ = lost ? TrackingState::kLost : TrackingState::kUncertain;
  }
  if (report.searched > 0 && report.matches < parameters_.min_inliers) {
    ++health.low_texture_frames;
    if (ok(report.status)) report.status = Status::kLowTexture;
  }
  if (state_ == TrackingState::kLost) report.status = Status::kLost;
  report.state = state_;
}

void TrackingEvidence::note_usual(const FrameReport& report) {
  constexpr float kOfLate = 0.1F;  // ten frames
  constexpr int kTelling = 8;
  if (report.searched < kTelling) return;
  const float share = static_cast<float>(report.inliers) / static_cast<float>(report.searched);
  usual_share_ += kOfLate * (share - usual_share_);
}

}  // namespace cairn
