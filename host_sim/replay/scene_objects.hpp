#pragma once

#include "cairn/runtime/window_augmentation.hpp"

namespace cairn::host {

/// Vehicle mode: 3.5 m ahead, 0.7 m to the left, on the floor.
inline const Vector3<float> kObjectFromVehicle_m(3.5F, 0.7F, 0.0F);
/// Heights of the cairns that a run draws: m, and in hand-held mode the filter's own unit.
inline constexpr float kVehicleObjectHeight = 1.0F;
inline constexpr float kHandheldObjectHeight = 0.3F;

/// The virtual objects of a run: the host's choice of shape and places.
class SceneObjects {
 public:
  explicit SceneObjects(float height) {
    VirtualObject shape;
    static_cast<void>(make_cairn(height, shape));
    augmenter_.initialise(shape, Augmenter::Parameters{});
  }

  template <class Tracker>
  void draw(const Tracker& tracker, const MutableImageView& overlay, const TickSource& ticks,
            FrameReport& report) {
    augment(tracker, augmenter_, placement_, overlay, ticks, report);
  }
  const Augmenter& augmenter() const { return augmenter_; }

 private:
  Augmenter augmenter_;
  ObjectPlacement placement_{kObjectFromVehicle_m, Random(1)};
};

}  // namespace cairn::host
