#pragma once

#include "cairn/map/landmark.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/tracking/tracked_landmarks.hpp"

namespace cairn {

/// Fills a library record with all but position and covariance: identity, search statistics, and
/// the one view that the tracker keeps of a landmark. `T_map_reference`: camera pose of that view.
inline void fill_archived(const TrackedLandmark& landmark, const PinholeCamera<float>& camera,
                          const Rigid<float>& T_map_reference, LibraryLandmark<float>& archived) {
  archived.id = landmark.id;
  archived.searches = static_cast<std::uint16_t>(clamp(landmark.predicted, 0, 0xFFFF));
  archived.sightings =
      static_cast<std::uint16_t>(clamp(landmark.measured, 0, int{archived.searches}));
  archived.view_count = 1;
  LandmarkView<float>& view = archived.views[0];
  view.descriptor = landmark.appearance.descriptor;
  view.pose.scale_index = landmark.appearance.scale_index;
  view.focal_px = 0.5F * (camera.fx + camera.fy);
  view.T_map_reference = T_map_reference;
}

/// The tracker's record of a landmark of the library that enters the filter again.
inline TrackedLandmark reactivated_landmark(LandmarkId id) {
  TrackedLandmark landmark;
  landmark.id = id;
  landmark.from_library = true;
  landmark.stored = true;
  return landmark;
}

}  // namespace cairn
