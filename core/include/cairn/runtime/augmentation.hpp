#pragma once

#include "cairn/ar/augmenter.hpp"
#include "cairn/planar/fixed/fixed_vehicle_slam.hpp"
#include "cairn/runtime/handheld_placement.hpp"
#include "cairn/runtime/handheld_tracker.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"

namespace cairn {

/// Where an application wants its virtual objects, and what finding a place needs.
struct ObjectPlacement {
  Vector3<float> p_vehicle_object = Vector3<float>::Zero();  ///< m; of a vehicle's objects
  Random random;  ///< of a hand-held camera's: drawing from it does not change the tracking
};

/// Vehicle: at p_vehicle_object, turned as the vehicle is.
template <class Config, class Filter>
bool find_object_place(const VehicleTracker<Config, Filter>& tracker, ObjectPlacement& placement,
                       Rigid<float>& T_map_object) {
  T_map_object = tracker.T_map_vehicle();
  T_map_object.translation = T_map_object * placement.p_vehicle_object;
  return true;
}
/// Hand-held camera: as place_on_features().
template <class Config>
bool find_object_place(const HandheldTracker<Config>& tracker, ObjectPlacement& placement,
                       Rigid<float>& T_map_object) {
  return place_on_features(tracker.filter(), placement.random, T_map_object);
}

/// The camera with which a tracker's frame is drawn.
template <class Config, class Filter>
PinholeCamera<float> drawing_camera(const VehicleTracker<Config, Filter>& tracker) {
  return tracker.camera();
}
template <class Config>
PinholeCamera<float> drawing_camera(const HandheldTracker<Config>& tracker) {
  return tracker.filter().camera();
}

/// Whether a tracker's frames are drawn without floating point.
template <class Tracker>
inline constexpr bool kDrawsInIntegers = false;
template <class Config, int MaxLandmarks>
inline constexpr bool kDrawsInIntegers<VehicleTracker<Config, FixedVehicleSlam<MaxLandmarks>>> =
    true;

/// Draws the objects of `augmenter` into `overlay`, as the frame of `report` sees them; nothing
/// while it is lost. Where the augmenter wants another object and the tracker tracks, one is placed
/// first. Adds its ticks to `report` as Stage::kRender. Cost: Augmenter::draw() and
/// find_object_place().
template <class Tracker>
void augment(const Tracker& tracker, Augmenter& augmenter, ObjectPlacement& placement,
             const MutableImageView& overlay, const TickSource& ticks, FrameReport& report) {
  const std::uint32_t start = ticks.now();
  if (tracker.state() == TrackingState::kTracking && augmenter.wants_object()) {
    Rigid<float> T_map_object;
    if (find_object_place(tracker, placement, T_map_object)) {
      static_cast<void>(augmenter.place(T_map_object));
    }
  }
  if (tracker.state() != TrackingState::kLost) {
    const auto camera = drawing_camera(tracker);
    if constexpr (kDrawsInIntegers<Tracker>) {
      augmenter.draw_in_integers(camera, report.T_map_camera, overlay);
    } else {
      augmenter.draw(camera, report.T_map_camera, overlay);
    }
  }
  report.stage_ticks[static_cast<int>(Stage::kRender)] = ticks.now() - start;
}

}  // namespace cairn
