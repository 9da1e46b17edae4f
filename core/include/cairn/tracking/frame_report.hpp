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
  std::int64_t t_us = 0;
  Kind kind = Kind::kTwist;
  float speed_mps = 0.0F;
  float turn = 0.0F;  ///< kTwist: yaw rate, rad/s; kAckermann: steering angle, rad
};

enum class TrackingState : std::uint8_t { kInitialising, kTracking, kUncertain, kLost };

/// What a frame left out for want of work units, in the order in which it gives things up.
enum class FrameCut : std::uint8_t {
  kNone,
  kFewerUpdates,    ///< landmarks in view were not searched, or matches not used
  kNoMapping,       ///< candidates not followed, or none begun
  kPredictionOnly,  ///< nothing was matched: the pose is odometry's
};

/// What one frame gave. The pose is the camera's in the world; in handheld mode the world is the
/// first camera and its scale is the filter's own.
struct FrameReport {
  std::int64_t t_us = 0;
  Status status = Status::kNotInitialised;
  TrackingState state = TrackingState::kInitialising;
  Rigid<float> T_world_camera;
  std::uint32_t stage_ticks[kStageCount] = {};
  int corners = 0;     ///< FAST corners found in the search windows
  int candidates = 0;  ///< descriptors computed
  int matches = 0;     ///< landmarks matched
  int inliers = 0;     ///< matches used by the filter
  int landmarks = 0;   ///< active landmarks after the frame
  int searched = 0;    ///< landmarks looked for
  int deferred = 0;    ///< landmarks in view that were not looked for, or matches not used
  int added = 0;
  int removed = 0;
  int reentered = 0;     ///< landmarks taken back from the map library
  int from_library = 0;  ///< inliers that once came back from it
  bool relocalised = false;
  FrameCut cut = FrameCut::kNone;
  int work = 0;  ///< units spent, drawing apart (WorkBudget)
  UpdateReport update;
};

}  // namespace cairn
