#pragma once

#include "cairn/tracking/camera_track.hpp"
#include "cairn/tracking/rolling_shutter.hpp"
#include "cairn/tracking/window_features.hpp"

namespace cairn {

/// How a rolling shutter exposed the present frame and the one before: turns pixels of features
/// into directions at the frame's time, and back. With a global shutter nothing changes by a bit.
class WindowExposures {
 public:
  using Window = KeyframeWindow<float, WindowBounds>;

  /// Starts anew, at rest. Domain: valid times.
  void reset(const ReadoutTimes& times, int width, int height) {
    present_.reset(times, width, height);
    before_ = present_;
  }
  bool used() const { return present_.used(); }
  /// The movement to the frame is that of the picture's readout.
  void expose(const CameraMovement& movement) {
    if (!used()) return;
    if (!movement.known) return present_.forget_motion();
    present_.set_motion(-movement.rate_radps, movement.velocity);
  }
  void forget_motion() {
    present_.forget_motion();
    before_.forget_motion();
  }
  /// The present frame is the one before.
  void end_frame() { before_ = present_; }

  const RollingShutter& present() const { return present_; }

  /// Direction of a feature at the frame's time, from a pose of it.
  Vector2<float> seen_direction(const PinholeCamera<float>& camera, const Window& window,
                                const WindowFeature& feature, const Rigid<float>& pose) const {
    const Vector3<float> ray = camera.unproject(feature.pixel);
    const Vector2<float> seen(ray.x(), ray.y());
    if (!used()) return seen;
    return present_.at_frame_time(seen, feature.pixel, window.inverse_depth_in(feature.slot, pose));
  }
  /// Pixel where the window expects a feature; relative to where it was in the frame at `before`,
  /// so that what its depth gets wrong counts only for the movement since.
  Vector2<float> expected_pixel(const PinholeCamera<float>& camera, const Window& window,
                                const WindowFeature& feature, const Rigid<float>& before,
                                const Rigid<float>& predicted) const;
  /// The window's newest keyframe, at a pose, sees what the frame found. What disagrees with that
  /// pose may be right while the start is not settled.
  template <class Features>
  void observe_keyframe(const PinholeCamera<float>& camera, const Features& features,
                        const Rigid<float>& pose, Window& window) const {
    for (int i = 0; i < features.size(); ++i) {
      const WindowFeature& feature = features[i];
      if (!feature.found) continue;
      const Vector2<float> direction = seen_direction(camera, window, feature, pose);
      if (feature.outliers == 0) {
        window.observe(feature.slot, direction);
      } else if (!window.settled()) {
        window.doubt(feature.slot, direction);
      }
    }
  }
  /// The frame before is the newest keyframe, and how it moved is known better now.
  template <class Features>
  void amend_keyframe(const PinholeCamera<float>& camera, const Features& features,
                      Window& window) const {
    const RollingShutter shutter = before_.with_next(present_);
    const Rigid<float>& keyframe = window.newest_pose();
    for (int i = 0; i < features.size(); ++i) {
      const WindowFeature& feature = features[i];
      const Vector2<float>& pixel = feature.keyframe_pixel;
      const Vector3<float> ray = camera.unproject(pixel);
      window.amend(feature.slot,
                   shutter.at_frame_time(Vector2<float>(ray.x(), ray.y()), pixel,
                                         window.inverse_depth_in(feature.slot, keyframe)));
    }
  }

 private:
  /// Direction in which the picture shows a feature that a camera sees along `direction` at the
  /// frame's time, by the moment of the pixel where it was seen last.
  static Vector2<float> skewed(const Vector2<float>& direction, const Window& window,
                               const WindowFeature& feature, const RollingShutter& shutter,
                               const Rigid<float>& pose) {
    if (!shutter.used()) return direction;
    return shutter.at_pixel_time(direction, feature.pixel,
                                 window.inverse_depth_in(feature.slot, pose));
  }

  RollingShutter present_;
  RollingShutter before_;
};

inline Vector2<float> WindowExposures::expected_pixel(const PinholeCamera<float>& camera,
                                                      const Window& window,
                                                      const WindowFeature& feature,
                                                      const Rigid<float>& before,
                                                      const Rigid<float>& predicted) const {
  Vector2<float> seen_before;
  Vector2<float> seen_after;
  Vector2<float> pixel_before;
  Vector2<float> pixel_after;
  if (!window.project(feature.slot, before, seen_before) ||
      !window.project(feature.slot, predicted, seen_after)) {
    return feature.pixel;
  }
  seen_before = skewed(seen_before, window, feature, before_, before);
  seen_after = skewed(seen_after, window, feature, present_, predicted);
  if (!ok(camera.project(Vector3<float>(seen_before.x(), seen_before.y(), 1.0F), pixel_before)) ||
      !ok(camera.project(Vector3<float>(seen_after.x(), seen_after.y(), 1.0F), pixel_after))) {
    return feature.pixel;
  }
  return feature.pixel + pixel_after - pixel_before;
}

}  // namespace cairn
