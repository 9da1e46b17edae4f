#pragma once

#include "cairn/runtime/window_tracker.hpp"

namespace cairn {

/// A keyframe seeks new landmarks in as many cells as the frame's work affords. Where those would
/// be too few, the next frame makes it, and searches less for it.
template <class Config>
void WindowTracker<Config>::keep_keyframes(FrameContext& frame) {
  const ViewChange change =
      view_change(camera_, features_, measurement_.exposures(), window_, track_.pose());
  const bool due = choice_.postponed_work() > 0;
  if (!due && !choice_.wants_keyframe(change)) return;
  const int least = work::kWindowNewest + features_.new_work(frame) / kLeastKeyframe;
  if (!due && !frame.work.affords(least)) {
    choice_.postpone(least);
    frame.work.raise_cut(FrameCut::kNoMapping);
    return;
  }
  static_cast<void>(make_keyframe(frame, choice_.moved(change)));
}

template <class Config>
void WindowTracker<Config>::begin_keyframe() {
  window_.begin_keyframe(track_.pose());
  Quaternion<float> turned;
  float variance = 0.0F;
  if (track_.note_keyframe(turned, variance)) window_.set_turn(turned, variance);
}

/// The present frame becomes a keyframe, and new landmarks begin in it. `moved`: the camera did,
/// since the one before.
template <class Config>
bool WindowTracker<Config>::make_keyframe(FrameContext& frame, bool moved) {
  const WindowExposures& exposures = measurement_.exposures();
  frame.work.spend(work::kWindowNewest);
  begin_keyframe();
  memory_.note_keyframe();
  for (int i = features_.size() - 1; i >= 0; --i) {
    if (!window_.used(features_[i].slot)) features_.remove(i);  // its host was given up
  }
  exposures.observe_keyframe(camera_, features_, track_.pose(), window_);
  features_.renew_templates(frame);
  const int added = features_.add(frame, window_, exposures.present(), next_id_);
  features_.note_keyframe();
  choice_.note_keyframe(features_.size());
  choice_.postpone(0);
  window_.finish_keyframe(moved);
  return added > 0;
}

/// The frame's pose stays where it is relative to the newest keyframe.
template <class Config>
void WindowTracker<Config>::improve_window(FrameContext& frame) {
  constexpr int kMostSteps = 64;
  if (window_.keyframes() == 0) return;
  const Rigid<float> before = window_.newest_pose();
  const int corrected = window_.corrected();
  ++frames_without_step_;
  for (int i = 0; i < kMostSteps && window_.working(); ++i) {
    const int each = window_.step_work();  // of the next step, which may be of another kind
    if (!frame.work.affords(each)) {
      frame.work.raise_cut(FrameCut::kNoMapping);
      break;
    }
    frame.work.spend(each);
    window_.step();
    frames_without_step_ = 0;
  }
  follow_focal();
  if (window_.corrected() != corrected) {
    track_.forget_motion();
    measurement_.exposures().forget_motion();
  }
  track_.correct(track_.pose() * before.inverse() * window_.newest_pose());
  for (int i = features_.size() - 1; i >= 0; --i) {
    if (!window_.live(features_[i].slot)) remove(frame, i);
  }
  track_.note_depth(window_.typical_inverse_depth(track_.pose()));
}

/// A new map where the camera is believed to be; after a loss, by the next frame where this one
/// spent its work on searches. False, still without one, where the picture shows
/// too little.
template <class Config>
bool WindowTracker<Config>::begin_anew(FrameContext& frame) {
  const bool first = state_ == TrackingState::kInitialising;
  window_.clear(track_.expected_inverse_depth());
  follow_focal();
  features_.clear();
  track_.forget_motion();
  measurement_.begin_anew();
  track_.stand_at(track_.pose());
  weak_frames_ = 0;
  static_cast<void>(make_keyframe(frame, true));
  if (features_.size() >= parameters_.min_inliers) {
    covariance_.begin(window_.newest());
    if (!first) ++health_.resets;
    return true;
  }
  window_.clear();
  features_.clear();
  return false;
}

/// The window begins anew at the pose in the map, with the landmarks that are seen there at their
/// depth in the map: its frame and scale are the map's again.
template <class Config>
void WindowTracker<Config>::return_to_map(FrameContext& frame) {
  track_.stand_at(memory_.place().T_map_camera.inverse());
  track_.forget_velocity();
  measurement_.exposures().forget_motion();
  measurement_.forget_agreement();
  window_.clear(parameters_.window.first_inverse_depth);
  follow_focal();
  features_.clear();
  begin_keyframe();
  memory_.take_place(frame, window_, features_);
  const WindowExposures& exposures = measurement_.exposures();
  exposures.observe_keyframe(camera_, features_, track_.pose(), window_);
  static_cast<void>(features_.add(frame, window_, exposures.present(), next_id_));
  choice_.note_keyframe(features_.size());
  window_.finish_keyframe();
  weak_frames_ = 0;
  covariance_.resume(window_.newest());
  state_ = TrackingState::kTracking;
  frame.report.relocalised = true;
  ++health_.relocalisations;
}

template <class Config>
Status WindowTracker<Config>::feature_position(int i, Vector3<float>& p,
                                               Matrix3<float>& covariance) const {
  if (i < 0 || i >= features_.size()) return Status::kNotFound;
  const int slot = features_[i].slot;
  const float rho = window_.inverse_depth(slot);
  const float relative = window_.sigma(slot) / rho;
  if (!(relative < 1.0F)) return Status::kNotFound;
  p = window_.position(slot);
  const Vector3<float> ray = p - window_.sighting(slot).host;
  const float squared = ray.squaredNorm();
  const float across = square(parameters_.window.sigma) * squared;
  covariance = across * Matrix3<float>::Identity() + square(relative) * (ray * ray.transpose());
  return Status::kOk;
}

template <class Config>
void WindowTracker<Config>::hash(Hash64& hash) const {
  window_.hash(hash);
  hash.add(static_cast<std::uint8_t>(state_));
  hash.add(health_.landmarks_added);
  hash.add(health_.landmarks_removed);
  for (int i = 0; i < 4; ++i) hash.add(track_.pose().rotation.coeffs()(i));
  for (int i = 0; i < 3; ++i) hash.add(track_.pose().translation(i));
}

}  // namespace cairn
