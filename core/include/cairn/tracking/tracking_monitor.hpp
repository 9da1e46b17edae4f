#pragma once

#include "cairn/base/health.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/tracking/frame_report.hpp"

namespace cairn {

/// What the landmark measurements of a frame came to.
struct MeasurementCounts {
  int searched = 0;
  int matches = 0;
  int inliers = 0;
  float nis = 0.0F;          ///< normalised innovation squared of the inliers, summed
  bool could_search = true;  ///< false: the work budget did not pay for a single search
};

/// Decides from the inlier counts of the frames whether tracking holds (TrackingState). Some
/// landmarks match by chance where the camera shows another place, and more of them agree by chance
/// where tiles or shelves repeat. So inliers are judged relative to the landmarks searched and to
/// the running mean of the inlier ratio.
class TrackingMonitor {
 public:
  struct Parameters {
    int min_inliers = 4;               ///< fewer: the frame is weak
    float uncertain_s_to_lost = 2.0F;  ///< of weak frames in a row
    float min_match_ratio = 0.08F;     ///< of the landmarks searched; fewer match by chance
    float min_mean_ratio = 0.5F;       ///< smallest inlier ratio, relative to its running mean
    float min_return_ratio = 0.3F;     ///< of the landmarks searched, after two weak frames
    int min_return_matches = 6;        ///< and at least so many
    float min_place_ratio = 0.7F;      ///< of the landmarks expected at a recognised place
    int probation_frames = 0;          ///< tracked frames until a recognised place counts as found

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good =
          min_inliers >= 1 && is_finite(uncertain_s_to_lost) && uncertain_s_to_lost >= 0.0F &&
          min_return_matches >= 0 && probation_frames >= 0 && min_match_ratio >= 0.0F &&
          min_match_ratio <= 1.0F && min_mean_ratio >= 0.0F && min_mean_ratio <= 1.0F &&
          min_return_ratio >= 0.0F && min_return_ratio <= 1.0F && min_place_ratio >= 0.0F &&
          min_place_ratio <= 1.0F;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    *this = TrackingMonitor();
    parameters_ = parameters;
  }

  /// Begins a frame that stands for `step_s` seconds.
  void begin_frame(float step_s) { step_s_ = step_s; }

  TrackingState state() const { return state_; }
  /// Weak frames in a row, up to now.
  int weak_frames() const { return weak_frames_; }
  const Parameters& parameters() const { return parameters_; }

  /// Whether the inliers are enough to determine the pose.
  bool holds(const MeasurementCounts& counts) const {
    return counts.inliers >= parameters_.min_inliers;
  }
  /// Whether the matches are more than chance finds. After weak frames the search windows are
  /// larger, and more matches are asked for; not where they were weak for want of landmarks
  /// (`thin`).
  bool enough_matches(const MeasurementCounts& counts, bool thin = false) const;
  /// Least number of inliers that RANSAC must find, at least `least`.
  int min_inliers(const MeasurementCounts& counts, int least) const;
  /// The same at a recognised place where `found` landmarks of the library were matched.
  int min_relocalisation_inliers(int found) const;
  /// Whether `found` of `expected` landmarks confirm a place: of the library, or of the filter and
  /// a pose beside odometry's.
  bool confirms_place(int found, int expected) const;

  /// Why a frame's landmarks do not determine the pose: kTracked where they do. `shortage`: why
  /// there are too few to search.
  NotTracked why_not_tracked(const MeasurementCounts& counts, NotTracked shortage) const;

  /// Ends a frame: returns its final status and moves the state on.
  Status judge(const MeasurementCounts& counts, Status status, Health& health);
  /// `frames` that did not come, or showed nothing new: weak ones, but whether tracking is lost is
  /// for the next frame with an image to decide.
  void note_blind_frames(int frames);
  /// The map in view changed: the running mean starts anew.
  void forget_mean() { mean_inlier_ratio_ = 0.0F; }

  /// A place was recognised and confirmed: tracking is uncertain for `probation_frames`, and one
  /// weak frame in that time ends it.
  void begin_probation();
  /// The map begins anew.
  void restart();
  /// The camera's place in the map is not known.
  void lose();

 private:
  void update_mean(const MeasurementCounts& counts);
  void note_weak_frame(bool could_search, Health& health);

  Parameters parameters_;
  TrackingState state_ = TrackingState::kInitialising;
  int weak_frames_ = 0;
  float weak_s_ = 0.0F;  ///< that they have lasted
  float step_s_ = 0.0F;
  int probation_ = 0;  ///< frames left
  float mean_inlier_ratio_ = 0.0F;
};

}  // namespace cairn
