#pragma once

#include "cairn/tracking/live_landmark.hpp"
#include "cairn/tracking/vehicle_estimate.hpp"

namespace cairn {

/// The landmarks of a vehicle's filter in the frame of the map: what is in view is still in the
/// filter, and the library has only what left it.
template <class Filter>
class LiveLandmarks {
 public:
  /// `wanted` false: none.
  LiveLandmarks(const VehicleEstimate<Filter>& estimate, const Rigid<float>& T_world_map,
                bool wanted)
      : estimate_(estimate), T_map_world_(T_world_map.inverse()), wanted_(wanted) {}

  int size() const { return wanted_ ? estimate_.size() : 0; }
  LandmarkId id(int slot) const { return estimate_.id(slot); }
  /// False where the slot holds no landmark that was found again since it was added. Cost: a look
  /// through the records.
  bool get(int slot, LiveLandmark& landmark) const {
    constexpr int kFewestSightings = 2;
    landmark.slot = slot;
    landmark.id = estimate_.id(slot);
    landmark.record = estimate_.landmarks().find(landmark.id);
    if (landmark.record == nullptr || landmark.record->measured < kFewestSightings) return false;
    landmark.p_map = T_map_world_ * estimate_.filter().mean_landmark(slot);
    return true;
  }
  /// A pose in the map, in the filter's frame, where the landmarks' reference views are.
  Rigid<float> to_world(const Rigid<float>& T_map_camera) const {
    return T_map_world_.inverse() * T_map_camera;
  }

 private:
  const VehicleEstimate<Filter>& estimate_;
  Rigid<float> T_map_world_;
  bool wanted_;
};

}  // namespace cairn
