#pragma once

#include "cairn/runtime/window_tracker.hpp"

namespace cairn {

/// Where the window expects a feature; relative to where it was, so that what its depth gets wrong
/// counts only for the movement since.
template <class Config>
Vector2<float> WindowTracker<Config>::expected_pixel(const WindowFeature& feature,
                                                     const Rigid<float>& predicted) const {
  Vector2<float> before;
  Vector2<float> after;
  Vector2<float> pixel_before;
  Vector2<float> pixel_after;
  if (!window_.project(feature.slot, T_camera_world_, before) ||
      !window_.project(feature.slot, predicted, after)) {
    return feature.pixel;
  }
  before = skewed(before, feature, shutter_before_, T_camera_world_);
  after = skewed(after, feature, shutter_, predicted);
  if (!ok(camera_.project(Vector3<float>(before.x(), before.y(), 1.0F), pixel_before)) ||
      !ok(camera_.project(Vector3<float>(after.x(), after.y(), 1.0F), pixel_after))) {
    return feature.pixel;
  }
  return feature.pixel + pixel_after - pixel_before;
}

template <class Config>
bool WindowTracker<Config>::search(FrameContext& frame, const Rigid<float>& predicted, int first,
                                   int last, int radius) {
  const bool near = radius < parameters_.features.wide_radius_px;
  const int each = work::template_search(radius) +
                   (near ? 2 : 1) * work::template_search(parameters_.features.full_radius_px);
  const bool window_waits = window_.working() && frames_without_step_ >= kMostWithoutStep;
  const int later = work::window_pose(first) + 2 * work::window_pose(kMaxFeatures) +
                    (window_waits ? window_.step_work() : 0) + reserved_;
  for (int i = first; i < last; ++i) {
    if (features_[i].found) continue;
    if (!frame.work.affords(each + later)) {
      frame.work.raise_cut(i == 0 ? FrameCut::kPredictionOnly : FrameCut::kFewerUpdates);
      return false;
    }
    const Vector2<float> expected = expected_pixel(features_[i], predicted);
    if (near) {
      features_.search_near(frame, i, expected, radius);
    } else {
      features_.search(frame, i, expected, radius);
    }
    ++frame.report.searched;
  }
  return true;
}

/// The first features are searched in wide windows. Where they agree on a pose, the others are
/// close to where it expects them.
template <class Config>
void WindowTracker<Config>::find_features(FrameContext& frame, const FrameStep& step,
                                          const Rigid<float>& predicted) {
  const typename Features::Parameters& p = parameters_.features;
  expose(predicted);
  const int most = takes_points_ ? parameters_.astray_features : features_.size();
  const int all = most < features_.size() ? most : features_.size();
  const int first = p.first_features < all ? p.first_features : all;
  reserved_ = keyframe_work_ < frame.work.left() / 2 ? keyframe_work_ : frame.work.left() / 2;
  const int radius = first_radius(frame, step);
  if (!search(frame, predicted, 0, first, radius)) return;
  Rigid<float> pose = predicted;
  bool agree = first_agree(frame, pose);
  if (!agree && radius < p.wide_radius_px) {
    if (!search(frame, predicted, 0, first, p.wide_radius_px)) return;
    pose = predicted;
    agree = first_agree(frame, pose);
  }
  search(frame, agree ? pose : predicted, first, all,
         agree ? p.narrow_radius_px : p.wide_radius_px);
}

/// Whether the features found first agree on a pose.
template <class Config>
bool WindowTracker<Config>::first_agree(FrameContext& frame, Rigid<float>& pose) {
  Matrix<float, 6, 6> covariance = Matrix<float, 6, 6>::Zero();
  const WindowPoseOptions<float> options = pose_options(pose);
  const int found = gather(pose);
  frame.work.spend(work::window_pose(found));
  const int inliers = estimate_window_pose(sightings_, found, options, pose, covariance);
  return inliers >= parameters_.min_inliers && 4 * inliers >= 3 * found;
}

/// A hand keeps its velocity from frame to frame, nearly: an observation of the camera's centre,
/// weighed as the landmarks are, whose errors count as independent. Where depths are unknown a
/// movement explains a turn nearly as well, and this tells the two apart. With a gyroscope that
/// agrees, the attitude that it predicts is one more observation.
template <class Config>
WindowPoseOptions<float> WindowTracker<Config>::pose_options(const Rigid<float>& predicted) const {
  WindowPoseOptions<float> options;
  options.sigma = parameters_.window.sigma / window_.focal_scale();
  const float centre_sigma = parameters_.velocity_change_sigma * unseen_s_ /
                             (expected_inverse_depth() * parameters_.covariance_factor);
  if (centre_sigma > 0.0F && !gap_) {
    options.centre = predicted.inverse().translation;
    options.centre_information = 1.0F / square(centre_sigma);
  }
  if (!gyro_.sure()) return options;
  options.attitude = predicted.rotation;
  options.attitude_information =
      1.0F / (gyro_.turn_variance() + frame_covariance_.topLeftCorner<3, 3>().trace() / 3.0F);
  return options;
}

/// The movement since the frame before is that of the picture's readout; the turn is the
/// gyroscope's, where it agrees.
template <class Config>
void WindowTracker<Config>::expose(const Rigid<float>& pose) {
  if (!shutter_.used()) return;
  if (gap_ || !(pose_age_s_ > 0.0F)) return shutter_.forget_motion();
  WindowMotion motion;
  motion.note(T_camera_world_, pose, pose_age_s_);
  const Vector3<float> rate = gyro_.sure() ? gyro_.turn().rate_after : motion.rate_radps();
  shutter_.set_motion(-rate, motion.velocity());
}

/// Direction of a feature at the frame's time.
template <class Config>
Vector2<float> WindowTracker<Config>::seen_direction(const WindowFeature& feature,
                                                     const Rigid<float>& pose) const {
  const Vector3<float> ray = camera_.unproject(feature.pixel);
  const Vector2<float> seen(ray.x(), ray.y());
  if (!shutter_.used()) return seen;
  return shutter_.at_frame_time(seen, feature.pixel, window_.inverse_depth_in(feature.slot, pose));
}

/// Direction in which the picture shows a feature that a camera sees along `direction` at the
/// frame's time, by the moment of the pixel where it was seen last.
template <class Config>
Vector2<float> WindowTracker<Config>::skewed(const Vector2<float>& direction,
                                             const WindowFeature& feature,
                                             const RollingShutter& shutter,
                                             const Rigid<float>& pose) const {
  if (!shutter.used()) return direction;
  return shutter.at_pixel_time(direction, feature.pixel,
                               window_.inverse_depth_in(feature.slot, pose));
}

/// What the frame found, as it would be seen at its time from `pose`.
template <class Config>
int WindowTracker<Config>::gather(const Rigid<float>& pose) {
  expose(pose);
  int count = 0;
  for (int i = 0; i < features_.size(); ++i) {
    const WindowFeature& feature = features_[i];
    if (!feature.found) continue;
    sightings_[count] = window_.sighting(feature.slot);
    sightings_[count].seen = seen_direction(feature, pose);
    sighted_[count++] = i;
  }
  return count;
}

}  // namespace cairn
