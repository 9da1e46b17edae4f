#pragma once

#include "cairn/runtime/window_tracker.hpp"

namespace cairn {

/// Half of the inliers have a depth that is known, or enough of them the library's.
template <class Config>
bool WindowTracker<Config>::depths_hold() const {
  int from_library = 0;
  for (int i = 0; i < features_.size(); ++i) {
    const WindowFeature& feature = features_[i];
    from_library += feature.found && feature.outliers == 0 && feature.from_library ? 1 : 0;
  }
  return 2 * known_depths() >= inliers_ || from_library >= parameters_.min_inliers;
}

/// While astray the memory takes points of some frames, which then search fewer features.
template <class Config>
bool WindowTracker<Config>::takes_points(const FrameContext& frame) const {
  const int wanted = memory_.wanted_work(frame.image);
  if (!astray_ || wanted == 0) return false;
  const int searches =
      parameters_.astray_features * (work::template_search(parameters_.features.wide_radius_px) +
                                     work::template_search(parameters_.features.full_radius_px));
  return frame.work.affords(searches + 3 * work::window_pose(parameters_.astray_features) + wanted);
}

/// With what the window left of the frame's work: archives what is known and, after a return to the
/// map, takes up what comes into view of it.
template <class Config>
void WindowTracker<Config>::keep_memory(FrameContext& frame) {
  if (astray_ || !window_.settled()) return;
  memory_.archive_due(frame, window_, features_, T_camera_world_, parameters_.window.sigma);
  memory_.keep_view(frame, features_, T_camera_world_, typical_inverse_depth_);
  if (returned_) memory_.reuse(frame, window_, features_, T_camera_world_);
}

/// While astray the place is sought in the library, for some time.
template <class Config>
void WindowTracker<Config>::seek_map(FrameContext& frame, const FrameStep& step, bool holds) {
  if (!astray_) return;
  if (holds) astray_s_ += static_cast<float>(step.us) * 1e-6F;
  if (astray_s_ > parameters_.forget_s) {
    memory_.forget();
    astray_ = false;
    return;
  }
  if (window_.keyframes() > 0 && memory_.recognise(frame, features_, T_camera_world_)) {
    return_to_map(frame);
  }
}

/// The window begins anew at the pose in the map, with the landmarks that are seen there at their
/// depth in the map: its frame and scale are the map's again.
template <class Config>
void WindowTracker<Config>::return_to_map(FrameContext& frame) {
  T_camera_world_ = memory_.place().T_map_camera.inverse();
  note_pose();
  window_.clear(parameters_.window.first_inverse_depth);
  follow_focal();
  features_.clear();
  motion_.forget_velocity();
  forget_exposures();
  window_.begin_keyframe(T_camera_world_);
  note_gyro_keyframe();
  memory_.take_place(frame, window_, features_);
  observe_features();
  static_cast<void>(features_.add(frame, window_, shutter_, next_id_));
  at_keyframe_ = features_.size();
  window_.finish_keyframe();
  since_keyframe_ = weak_frames_ = 0;
  attitude_[window_.newest()] = lost_attitude_;
  blind_s_ = blind_variance_ = 0.0F;
  astray_ = false;
  returned_ = true;
  state_ = TrackingState::kTracking;
  frame.report.relocalised = true;
  ++health_.relocalisations;
}

}  // namespace cairn
