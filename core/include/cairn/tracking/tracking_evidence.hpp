#pragma once

#include "cairn/base/health.hpp"
#include "cairn/tracking/frame_report.hpp"

namespace cairn {

/// What the matches of a vehicle's frames say of its tracking. A few landmarks are found by chance
/// where the camera shows another place; tiles, shelves and pillars let more of them agree than
/// chance does. So matches count by how many were looked for, and by how many agreed of late.
class TrackingEvidence {
 public:
  struct Parameters {
    int min_inliers = 4;
    int uncertain_frames_to_lost = 60;
    float min_match_share = 0.08F;   ///< of the landmarks looked for; fewer are taken for chance
    float min_usual_share = 0.5F;    ///< of the inliers that the last frames let expect
    float min_return_share = 0.3F;   ///< of the landmarks looked for, after two weak frames
    int min_return_matches = 6;      ///< and at least so many
    float min_library_share = 0.7F;  ///< of what the library should show from a place looked up
  };

  void reset(const Parameters& parameters) {
    *this = TrackingEvidence();
    parameters_ = parameters;
  }

  TrackingState state() const { return state_; }
  int weak_frames() const { return weak_frames_; }
  /// Whether the landmarks that the filter used hold the pose.
  bool consistent(const FrameReport& report) const {
    return report.inliers >= parameters_.min_inliers;
  }
  /// Whether `matches` of the landmarks looked for are more than chance finds.
  bool worth_an_update(const FrameReport& report, int matches) const;
  /// Matches that must agree, at least `least`.
  int support_wanted(const FrameReport& report, int least) const;
  /// Of `found` landmarks of the library at a place looked up, so many must agree.
  int support_of_place(int found) const;
  /// Whether `found` of `expected` landmarks of the library tell a place looked up.
  bool tells_place(int found, int expected) const;
  /// Ends a frame: the state, its status and the counters that follow from it.
  void judge(FrameReport& report, Health& health);
  /// What is in view changed: nothing follows from the frames before.
  void forget_usual() { usual_share_ = 0.0F; }

 private:
  void note_usual(const FrameReport& report);

  Parameters parameters_;
  TrackingState state_ = TrackingState::kInitialising;
  int weak_frames_ = 0;
  float usual_share_ = 0.0F;  ///< of the landmarks looked for, inliers of late
};

}  // namespace cairn
