#pragma once

#include "cairn/runtime/augmentation.hpp"
#include "cairn/runtime/window_tracker.hpp"

namespace cairn {

/// What augment() asks of a WindowTracker.
template <class Config>
bool find_object_place(const WindowTracker<Config>& tracker, ObjectPlacement& placement,
                       Rigid<float>& T_map_object) {
  return place_on_features(tracker, placement.random, T_map_object);
}
template <class Config>
PinholeCamera<float> drawing_camera(const WindowTracker<Config>& tracker) {
  return tracker.camera();
}

}  // namespace cairn
