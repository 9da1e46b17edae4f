#pragma once

#include "cairn/geometry/types.hpp"
#include "cairn/tracking/tracked_landmarks.hpp"

namespace cairn {

/// A landmark of the filter as a place to be recognised.
struct LiveLandmark {
  int slot = -1;  ///< in the filter
  LandmarkId id = kNoLandmark;
  Vector3<float> p_map = Vector3<float>::Zero();
  const TrackedLandmark* record = nullptr;
};

}  // namespace cairn
