#pragma once

#include "cairn/tracking/window_memory.hpp"

namespace cairn {

template <class Config>
bool WindowMemory<Config>::is_due(const WindowFeature& feature) const {
  const int mature = parameters_.mature_sightings;
  if (!feature.in_library) return feature.sightings >= mature;
  int next = mature;
  while (next < feature.sightings) next *= 2;
  return next == feature.sightings;
}

template <class Config>
void WindowMemory<Config>::archive_due(FrameContext& frame, const Window& window,
                                       Features& features, const Rigid<float>& T_camera_world,
                                       float sigma) {
  constexpr int kMaxInFrame = 4;  // the others follow in the next frames
  int archived = 0;
  for (int i = 0; i < features.size() && archived < kMaxInFrame; ++i) {
    WindowFeature& feature = features[i];
    if (!feature.found || feature.outliers > 0 || !is_due(feature)) continue;
    if (!(window.sigma(feature.slot) <
          parameters_.max_depth_sigma * window.inverse_depth(feature.slot))) {
      continue;
    }
    if (!frame.work.take(work::kArchiving + work::kDescriptor)) return;
    archive(frame, window, feature, T_camera_world, sigma);
    ++archived;
  }
  // Those that the library has already, in turn: their depths are known better by now.
  constexpr int kRenewed = 2;
  for (int i = 0; i < kRenewed && features.size() > 0; ++i) {
    next_renewed_ = (next_renewed_ + 1) % features.size();
    renew_depth(frame, window, features[next_renewed_], sigma);
  }
}

/// Slot of the landmark at a place, seen from a distance, -1 where there is none: a point that was
/// lost and found again is in the library already.
template <class Config>
int WindowMemory<Config>::same_point(const Vector3<float>& p_map, float distance) const {
  const float reach = parameters_.same_share * distance;
  int best = -1;
  float nearest = square(reach);
  for (int slot = 0; slot < library_.size(); ++slot) {
    const float squared = (library_[slot].p_map - p_map).squaredNorm();
    if (!(squared < nearest)) continue;
    nearest = squared;
    best = slot;
  }
  return best;
}

/// Where the window has a landmark, which its first view should have the pose of. The covariance is
/// that of the depth, the poses known, and of the pixel.
template <class Config>
void WindowMemory<Config>::place_landmark(const Window& window, int slot, float sigma,
                                          typename Library::Landmark& landmark) const {
  constexpr float kLeastSigma = 0.01F;  // of the depth
  landmark.p_map = window.position(slot);
  const Vector3<float> ray = landmark.p_map - landmark.views[0].T_map_reference.translation;
  const float own = window.sigma(slot) / window.inverse_depth(slot);
  const float along = square(own > kLeastSigma ? own : kLeastSigma);
  landmark.covariance = square(sigma) * ray.squaredNorm() * Matrix3<float>::Identity() +
                        along * (ray * ray.transpose());
}

template <class Config>
void WindowMemory<Config>::renew_depth(FrameContext& frame, const Window& window,
                                       const WindowFeature& feature, float sigma) {
  if (!feature.in_library || feature.from_library || !window.used(feature.slot)) return;
  const int slot = library_.find(window.id(feature.slot));
  if (slot < 0 || !(window.sigma(feature.slot) <
                    parameters_.max_depth_sigma * window.inverse_depth(feature.slot))) {
    return;
  }
  if (!frame.work.take(kRenewal)) return;
  typename Library::Landmark landmark = library_[slot];
  place_landmark(window, feature.slot, sigma, landmark);
  static_cast<void>(library_.update(landmark));
}

template <class Config>
void WindowMemory<Config>::archive(FrameContext& frame, const Window& window,
                                   WindowFeature& feature, const Rigid<float>& T_camera_world,
                                   float sigma) {
  typename Library::Landmark landmark;
  LandmarkView<float>& view = landmark.views[0];
  view.pose.scale_index = kReferenceScaleIndex;
  view.pose.orientation_bin = roll_bin(T_camera_world);
  if (!ok(describe_freak(frame.image, round_to_int(feature.pixel.x()),
                         round_to_int(feature.pixel.y()), view.pose, view.descriptor))) {
    return;
  }
  view.focal_px = 0.5F * (frame.camera.fx + frame.camera.fy);
  view.T_map_reference = T_camera_world.inverse();
  landmark.id = window.id(feature.slot);
  place_landmark(window, feature.slot, sigma, landmark);
  const Vector3<float> ray = landmark.p_map - view.T_map_reference.translation;
  if (library_.find(landmark.id) < 0) {
    const int known = same_point(landmark.p_map, sqrt(ray.squaredNorm()));
    if (known >= 0) landmark.id = library_[known].id;
  }
  landmark.searches = feature.searches;
  landmark.sightings = feature.sightings < feature.searches ? feature.sightings : feature.searches;
  landmark.view_count = 1;
  const Status status = library_.find(landmark.id) < 0 ? library_.insert(landmark, health_)
                                                       : library_.update(landmark);
  if (ok(status)) {
    coarse_[library_.find(landmark.id)] = feature.coarse;
    ++frame.health.landmarks_archived;
  }
  feature.in_library = true;
}

/// Describes what the frame found, then further points.
template <class Config>
void WindowMemory<Config>::capture(FrameContext& frame, Features& features,
                                   const Rigid<float>& T_camera_world) {
  const std::uint8_t bin = roll_bin(T_camera_world);
  recogniser_.reset();
  for (int i = 0; i < features.size(); ++i) {
    if (features[i].found) {
      static_cast<void>(recogniser_.add(frame.image, features[i].pixel, bin));
    }
  }
  const int most = Recogniser::kMaxPoints - recogniser_.points();
  const typename Features::Candidates& points = features.spread_points(frame, most);
  for (int i = 0; i < points.cells(); ++i) {
    if (!points.is_open(i)) continue;
    const Vector2<float> pixel(points[i].x, points[i].y);
    static_cast<void>(recogniser_.add(frame.image, pixel, bin));
  }
  frame.work.spend(recogniser_.points() * work::kDescriptor + kSelection);
}

}  // namespace cairn
