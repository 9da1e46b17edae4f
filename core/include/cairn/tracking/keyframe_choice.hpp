#pragma once

#include "cairn/tracking/window_exposures.hpp"
#include "cairn/tracking/window_features.hpp"

namespace cairn {

/// How the view changed since a keyframe, over the landmarks that it and the frame see; means, in
/// pixels.
struct ViewChange {
  int found = 0;  ///< by the frame, whether the keyframe sees them or not
  int common = 0;
  float flow = 0.0F;
  float parallax = 0.0F;  ///< what is left of it without the turn
};

/// Features of the frame at `pose`, and the window's newest keyframe.
template <class Features>
ViewChange view_change(const PinholeCamera<float>& camera, const Features& features,
                       const WindowExposures& exposures, const typename Features::Window& window,
                       const Rigid<float>& pose) {
  const Quaternion<float> turned = pose.rotation * window.newest_pose().rotation.conjugate();
  const Matrix3<float> rotation = turned.toRotationMatrix();
  ViewChange change;
  for (int i = 0; i < features.size(); ++i) {
    if (!features[i].found) continue;
    ++change.found;
    Vector2<float> before;
    if (!window.newest_sees(features[i].slot, before)) continue;
    const Vector3<float> p = rotation * Vector3<float>(before.x(), before.y(), 1.0F);
    if (!(p.z() > 0.0F)) continue;
    const Vector2<float> seen = exposures.seen_direction(camera, window, features[i], pose);
    change.flow += sqrt((seen - before).squaredNorm());
    change.parallax += sqrt((seen - Vector2<float>(p.x(), p.y()) / p.z()).squaredNorm());
    ++change.common;
  }
  if (change.common > 0) {
    const float share = camera.fx / static_cast<float>(change.common);
    change.flow *= share;
    change.parallax *= share;
  }
  return change;
}

/// Which frames of a WindowTracker become keyframes.
class KeyframeChoice {
 public:
  struct Parameters {
    float keyframe_parallax_px = 12.0F;  ///< mean since the last keyframe, its rotation apart
    float keyframe_share = 0.75F;  ///< found of the last one's features, below which one is made
    int keyframe_frames = 12;      ///< since the last one, at most, of a camera that does not stand
    float standing_px = 4.0F;      ///< mean flow, or parallax, below which it does

    /// kBadConfig unless every value is finite and in its domain.
    Status validate() const {
      const bool good = is_positive(keyframe_parallax_px) && is_finite(keyframe_share) &&
                        keyframe_share >= 0.0F && keyframe_share <= 1.0F && keyframe_frames >= 1 &&
                        is_finite(standing_px) && standing_px >= 0.0F;
      return good ? Status::kOk : Status::kBadConfig;
    }
  };

  void reset(const Parameters& parameters) {
    *this = KeyframeChoice();
    parameters_ = parameters;
  }
  /// A frame is tracked.
  void note_frame() { ++frames_; }
  /// A keyframe is made, with so many features.
  void note_keyframe(int features) {
    features_ = features;
    frames_ = 0;
  }
  /// One that is due waits for the next frame, which should leave it so many units of work; 0: it
  /// waits no more.
  void postpone(int work) { postponed_work_ = work; }

  bool wants_keyframe(const ViewChange& change) const {
    if (frames_ < 2) return false;
    const float least = parameters_.keyframe_share * static_cast<float>(features_);
    return change.parallax > parameters_.keyframe_parallax_px || 2 * change.common < change.found ||
           static_cast<float>(change.found) < least ||
           (frames_ >= parameters_.keyframe_frames && change.flow > parameters_.standing_px);
  }
  /// Whether the camera moved since the last keyframe.
  bool moved(const ViewChange& change) const { return change.parallax > parameters_.standing_px; }
  /// Whether the frame before is the last keyframe.
  bool follows_keyframe() const { return frames_ == 1; }
  /// Of a keyframe that was put off, 0: none was.
  int postponed_work() const { return postponed_work_; }

 private:
  Parameters parameters_;
  int frames_ = 0;    ///< since the last one
  int features_ = 0;  ///< after it
  int postponed_work_ = 0;
};

}  // namespace cairn
