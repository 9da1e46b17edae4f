#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/base/ticks.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/geometry/rigid.hpp"

namespace cairn {

/// Vehicle odometry over the time since the sample before it.
struct OdometrySample {
  enum class Kind : std::uint8_t { kTwist, kAckermann };
  static constexpr unsigned kKindCount = 2;
  std::int64_t t_us = 0;
  Kind kind = Kind::kTwist;
  float speed_mps = 0.0F;
  float turn = 0.0F;  ///< kTwist: yaw rate, rad/s; kAckermann: steering angle, rad
};

enum class TrackingState : std::uint8_t { kInitialising, kTracking, kUncertain, kLost };

/// What a frame left out because its work units did not suffice; a later one includes the earlier.
enum class FrameCut : std::uint8_t {
  kNone,
  kFewerUpdates,    ///< landmarks in view were not searched, or matches not used
  kNoMapping,       ///< seeds not followed, or none begun
  kPredictionOnly,  ///< nothing was searched: the pose is predicted only
};

/// Why a frame did not determine the pose: the first of the chain from odometry to consensus that
/// failed.
enum class NotTracked : std::uint8_t {
  kTracked,
  kNoOdometry,   ///< none came yet, or not for longer than the largest step
  kNoNewImage,   ///< the picture is the one before
  kNoWork,       ///< the work limit did not pay for a single search
  kNoCorners,    ///< too few landmarks in view, and no seeds: the picture has too few corners
  kSeedsLost,    ///< same, and most seeds were not found again
  kNoDepth,      ///< same, and the seeds' depths are not known yet
  kNotFound,     ///< too few of the landmarks in view were found
  kNoConsensus,  ///< enough were found, but they do not agree on a pose
};
inline constexpr int kNotTrackedCount = 9;

/// What one frame gave: an output, written by the tracker and read by its caller.
///
/// Two frames of reference. The filter estimates in `world`, the map library keeps its landmarks in
/// `map`. They are the same until a vehicle recognises landmarks of its library; from then on the
/// filter estimates the transform between them (MapAlignment). What is drawn, compared with earlier
/// runs or written down is in the map. In hand-held mode both are the camera of the first frame, in
/// the filter's own unit of length.
struct FrameReport {
  std::int64_t t_us = 0;
  Status status = Status::kNotInitialised;
  TrackingState state = TrackingState::kInitialising;
  Rigid<float> T_map_camera;    ///< the camera in the map's frame
  Rigid<float> T_world_camera;  ///< the camera in the filter's frame
  std::uint32_t stage_ticks[kStageCount] = {};
  int corners = 0;     ///< FAST corners found in the search windows
  int candidates = 0;  ///< descriptors computed
  int matches = 0;     ///< landmarks matched
  int inliers = 0;     ///< matches used by the filter
  int landmarks = 0;   ///< active landmarks after the frame
  int searched = 0;    ///< landmarks searched
  int deferred = 0;    ///< landmarks in view that were not searched, or matches not used
  int added = 0;
  int removed = 0;
  int reactivated = 0;   ///< landmarks reactivated from the map library
  int from_library = 0;  ///< inliers that were once reactivated
  bool relocalised = false;
  FrameCut cut = FrameCut::kNone;
  NotTracked not_tracked = NotTracked::kTracked;  ///< vehicle mode only
  int work = 0;                                   ///< units spent, drawing apart (WorkBudget)
  UpdateReport update;
};

}  // namespace cairn
