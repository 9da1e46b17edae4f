#pragma once

#include <vector>

#include "host_sim/trackers/tracker.hpp"

namespace cairn::host {

/// Adds the landmarks of a library that `holds` does not say to be held elsewhere.
template <class Library, class Holds>
void add_library(const Library& library, const Holds& holds, std::vector<MapLandmark>& all) {
  for (int slot = 0; slot < library.size(); ++slot) {
    const auto& landmark = library[slot];
    if (holds(landmark.id)) continue;
    all.push_back({landmark.id, landmark.p_map.template cast<double>(),
                   landmark.covariance.template cast<double>(), false});
  }
}

/// A vehicle tracker's landmarks, those of its filter and those that are in the library alone, all
/// in the map's frame. `Core`: VehicleTracker.
template <class Core>
std::vector<MapLandmark> landmarks_in_map(const Core& core) {
  std::vector<MapLandmark> all;
  const auto& filter = core.filter();
  const Rigid<float> T_map_world = core.T_world_map().inverse();
  const Matrix3<float> R = T_map_world.rotation.toRotationMatrix();
  for (int slot = 0; slot < filter.landmark_count(); ++slot) {
    const Vector3<float> p_map = T_map_world * filter.landmark_position(slot);
    const Matrix3<float> covariance = R * filter.landmark_covariance(slot) * R.transpose();
    all.push_back({filter.landmark_id(slot), p_map.template cast<double>(),
                   covariance.template cast<double>(), true});
  }
  add_library(
      core.library(), [&](LandmarkId id) { return filter.find(id) >= 0; }, all);
  return all;
}

}  // namespace cairn::host
