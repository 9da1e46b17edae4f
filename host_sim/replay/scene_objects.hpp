#pragma once

#include "cairn/runtime/window_augmentation.hpp"

namespace cairn::host {

/// Where and when objects are placed.
struct ScenePlan {
  Vector3<float> p_vehicle_object;  ///< vehicle mode, on the floor, m
  int frames_without_object;
};

/// Eight cairns of this plan keep one in view in 98 % of a lap of the hall.
inline const ScenePlan kFarObjects{{6.0F, 1.5F, 0.0F}, 5};
/// Drawn larger, so at a higher cost.
inline const ScenePlan kNearObjects{{3.5F, 0.7F, 0.0F}, 45};
/// Heights of the cairns that a run draws: m, and in hand-held mode the filter's own unit.
inline constexpr float kVehicleObjectHeight = 1.0F;
inline constexpr float kHandheldObjectHeight = 0.3F;

/// The virtual objects of a run: the host's choice of shape and places.
class SceneObjects {
 public:
  explicit SceneObjects(float height, const ScenePlan& plan = kFarObjects)
      : placement_{plan.p_vehicle_object, Random(1)} {
    VirtualObject shape;
    static_cast<void>(make_cairn(height, shape));
    Augmenter::Parameters parameters;
    parameters.frames_without_object = plan.frames_without_object;
    augmenter_.initialise(shape, parameters);
  }

  template <class Tracker>
  void draw(const Tracker& tracker, const MutableImageView& overlay, const TickSource& ticks,
            FrameReport& report) {
    augment(tracker, augmenter_, placement_, overlay, ticks, report);
  }
  const Augmenter& augmenter() const { return augmenter_; }

 private:
  Augmenter augmenter_;
  ObjectPlacement placement_;
};

}  // namespace cairn::host
