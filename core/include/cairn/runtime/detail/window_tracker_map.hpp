#pragma once

#include "cairn/runtime/window_tracker.hpp"

namespace cairn {

/// The newest keyframe sees what the frame found. What disagrees with the frame's pose may be right
/// while the start is not settled.
template <class Config>
void WindowTracker<Config>::observe_features() {
  for (int i = 0; i < features_.size(); ++i) {
    const WindowFeature& feature = features_[i];
    if (!feature.found) continue;
    const Vector2<float> direction = seen_direction(feature, T_camera_world_);
    if (feature.outliers == 0) {
      window_.observe(feature.slot, direction);
    } else if (!window_.settled()) {
      window_.doubt(feature.slot, direction);
    }
  }
}

/// The frame before is the newest keyframe, and how it moved is known better now.
template <class Config>
void WindowTracker<Config>::amend_keyframe(const RollingShutter& shutter) {
  const Rigid<float>& keyframe = window_.newest_pose();
  for (int i = 0; i < features_.size(); ++i) {
    const WindowFeature& feature = features_[i];
    const Vector2<float>& pixel = feature.keyframe_pixel;
    const Vector3<float> ray = camera_.unproject(pixel);
    window_.amend(feature.slot,
                  shutter.at_frame_time(Vector2<float>(ray.x(), ray.y()), pixel,
                                        window_.inverse_depth_in(feature.slot, keyframe)));
  }
}

/// The present frame becomes a keyframe, and new landmarks begin in it. `moved`: the camera did,
/// since the one before.
template <class Config>
bool WindowTracker<Config>::make_keyframe(FrameContext& frame, bool moved) {
  frame.work.spend(work::kWindowNewest);
  window_.begin_keyframe(T_camera_world_);
  note_gyro_keyframe();
  memory_.note_keyframe();
  for (int i = features_.size() - 1; i >= 0; --i) {
    if (!window_.used(features_[i].slot)) features_.remove(i);  // its host was given up
  }
  observe_features();
  features_.renew_templates(frame);
  const int added = features_.add(frame, window_, shutter_, next_id_);
  features_.note_keyframe();
  at_keyframe_ = features_.size();
  window_.finish_keyframe(moved);
  since_keyframe_ = keyframe_work_ = 0;
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
  if (window_.corrected() != corrected) forget_motion();
  T_camera_world_ = T_camera_world_ * before.inverse() * window_.newest_pose();
  T_camera_world_.rotation.coeffs() *= 1.0F / sqrt(T_camera_world_.rotation.squaredNorm());
  for (int i = features_.size() - 1; i >= 0; --i) {
    if (!window_.live(features_[i].slot)) remove(frame, i);
  }
  const float typical = window_.typical_inverse_depth(T_camera_world_);
  if (typical > 0.0F) typical_inverse_depth_ = typical;
}

template <class Config>
void WindowTracker<Config>::note_weak(FrameContext& frame) {
  ++weak_frames_;
  if (!gyro_.sure()) motion_.forget();
  state_ = TrackingState::kUncertain;
  if (weak_frames_ <= parameters_.weak_frames && features_.size() >= parameters_.min_inliers)
    return;
  ++health_.losses;
  if (!astray_) {
    lost_attitude_ = attitude_[window_.newest()] + attitude_by_focal();
    for (int i = 0; i < features_.size(); ++i) {
      memory_.renew_depth(frame, window_, features_[i], parameters_.window.sigma);
    }
  }
  astray_ = !memory_.library_too_small();
  astray_s_ = 0.0F;
  returned_ = false;
  if (astray_) {
    memory_.begin();
  } else {
    memory_.forget();  // the new map has another frame
  }
  state_ = TrackingState::kLost;
  features_.clear();
  window_.clear();
  if (frame.work.affords(work::kWindowNewest + features_.new_work(frame))) {
    static_cast<void>(begin_anew(frame));
  }
}

/// A new map where the camera is believed to be; after a loss, by the next frame where this one
/// spent its work on searches. False, still without one, where the picture shows
/// too little.
template <class Config>
bool WindowTracker<Config>::begin_anew(FrameContext& frame) {
  const bool first = state_ == TrackingState::kInitialising;
  window_.clear(expected_inverse_depth());
  follow_focal();
  features_.clear();
  forget_motion();
  note_pose();
  weak_frames_ = 0;
  static_cast<void>(make_keyframe(frame, true));
  if (features_.size() >= parameters_.min_inliers) {
    attitude_[window_.newest()] =
        lost_attitude_ + (square(parameters_.blind_rate_radps * blind_s_) + blind_variance_) *
                             Matrix3<float>::Identity();
    blind_s_ = blind_variance_ = 0.0F;
    if (!first) ++health_.resets;
    return true;
  }
  window_.clear();
  features_.clear();
  return false;
}

template <class Config>
int WindowTracker<Config>::known_depths() const {
  int known = 0;
  for (int i = 0; i < features_.size(); ++i) {
    const WindowFeature& feature = features_[i];
    known += feature.found && window_.sigma(feature.slot) <
                                  parameters_.known_depth * window_.inverse_depth(feature.slot)
                 ? 1
                 : 0;
  }
  return known;
}

/// The attitude's error is that of the window's reference when it was the newest keyframe, of the
/// newest keyframe relative to it, of the frame relative to the landmarks, what the focal length's
/// error makes of them, and the rest of the calibration of all turns.
template <class Config>
void WindowTracker<Config>::update_covariance() {
  if (window_.keyframes() == 0) return;
  const float inflation = square(parameters_.covariance_factor);
  const Matrix<float, 6, 6>& newest = window_.newest_covariance();
  const Matrix3<float> newest_axes = window_.newest_pose().rotation.conjugate().toRotationMatrix();
  const int reference = window_.reference();
  if (window_.newest() != reference) {
    attitude_[window_.newest()] =
        attitude_[reference] +
        inflation * (newest_axes * newest.topLeftCorner<3, 3>() * newest_axes.transpose());
  }
  const Matrix3<float> R_world_camera = T_camera_world_.rotation.conjugate().toRotationMatrix();
  const Vector3<float> turned = rotation_log(T_camera_world_.rotation);
  const float unknown = square(parameters_.lens_sigma) * turned.squaredNorm() +
                        square(parameters_.blind_rate_radps * blind_s_) + blind_variance_;
  covariance_ = Matrix<float, 6, 6>::Zero();
  const Matrix<float, 6, 6> own = inflation * (frame_covariance_ + newest);
  covariance_.topLeftCorner<3, 3>() = own.bottomRightCorner<3, 3>();
  covariance_.bottomRightCorner<3, 3>() =
      R_world_camera.transpose() * (attitude_[window_.newest()] + attitude_by_focal()) *
          R_world_camera +
      inflation * frame_covariance_.topLeftCorner<3, 3>() + unknown * Matrix3<float>::Identity();
}

/// The attitude's covariance from the focal length's, in world axes: the newest keyframe follows it
/// as the window says, and what the camera turned since shrinks as it grows.
template <class Config>
Matrix3<float> WindowTracker<Config>::attitude_by_focal() const {
  const FocalScale focal = focal_scale();
  const Quaternion<float> since =
      T_camera_world_.rotation * window_.newest_pose().rotation.conjugate();
  const Vector3<float> follows =
      window_.newest_pose().rotation.conjugate() * window_.newest_by_focal().template head<3>() -
      T_camera_world_.rotation.conjugate() * rotation_log(since) / focal.value;
  return square(focal.sigma) * (follows * follows.transpose());
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
  for (int i = 0; i < 4; ++i) hash.add(T_camera_world_.rotation.coeffs()(i));
  for (int i = 0; i < 3; ++i) hash.add(T_camera_world_.translation(i));
}

}  // namespace cairn
