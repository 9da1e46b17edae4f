#pragma once

#include "cairn/numeric/median.hpp"
#include "cairn/window/keyframe_window.hpp"

namespace cairn {

template <class T, class Bounds>
Status KeyframeWindow<T, Bounds>::initialise(const Parameters& parameters) {
  const Status status = parameters.validate();
  if (!ok(status)) return status;
  parameters_ = parameters;
  focal_.reset(parameters.focal_sigma);
  clear();
  return Status::kOk;
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::clear() {
  graph_.clear();
  focal_.clear(parameters_.focal_factor);
  equations_.forget();
  start_.clear();
  solution_.focal = focal_.mean();
  newest_covariance_.setZero();
  moved_ = left_ = 0;
  anchored_ = false;
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::begin_keyframe(const Rigid<T>& T_camera_world) {
  if (graph_.places().full()) {
    const int index = graph_.worst_keyframe(solution_, T_camera_world);
    focal_.leave(graph_.places()[index]);
    graph_.drop(index);
  }
  const int last = graph_.keyframes() > 0 ? graph_.newest() : -1;
  const int pose = graph_.add_keyframe();
  focal_.forget_pose(pose);
  new_depth_ = T(0);
  solution_.pose[pose] = T_camera_world;
  start_.stop();
  if (last >= 0) start_.add_keyframe(pose, last, T_camera_world * solution_.pose[last].inverse());
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::set_turn(const Quaternion<T>& R_before_newest, T variance) {
  graph_.set_turn(R_before_newest.conjugate(), variance);
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::observe(int slot, const Vector2<T>& seen) {
  graph_.observe(slot, solution_.as_told(seen));
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::doubt(int slot, const Vector2<T>& seen) {
  graph_.doubt(slot, solution_.as_told(seen));
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::amend(int slot, const Vector2<T>& seen) {
  graph_.amend(slot, solution_.as_told(seen));
}

template <class T, class Bounds>
bool KeyframeWindow<T, Bounds>::newest_sees(int slot, Vector2<T>& seen) const {
  if (!graph_.newest_sees(slot)) return false;
  seen = solution_.as_estimated(graph_.observed(graph_.places().back(), slot));
  return true;
}

template <class T, class Bounds>
T KeyframeWindow<T, Bounds>::expected_inverse_depth() {
  if (!(new_depth_ > T(0))) {
    const T typical = typical_inverse_depth(newest_pose());
    new_depth_ = typical > T(0) ? typical : parameters_.first_inverse_depth;
  }
  return new_depth_;
}

template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::add_landmark(LandmarkId id, const Vector2<T>& seen) {
  const T prior = expected_inverse_depth();
  const int slot =
      add_known_landmark(id, newest(), seen, prior, parameters_.depth_prior_sigma * prior);
  if (slot >= 0) observe(slot, seen);
  return slot;
}

template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::add_host(const Rigid<T>& T_camera_world) {
  const int pose = graph_.take_pose();
  focal_.forget_pose(pose);
  solution_.pose[pose] = T_camera_world;
  start_.add_host(pose, T_camera_world);
  anchored_ = anchored_ || started() == 1;
  return pose;
}

template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::add_known_landmark(LandmarkId id, int host, const Vector2<T>& ray,
                                                  T inverse_depth, T sigma) {
  Landmark landmark;
  landmark.id = id;
  landmark.ray = solution_.as_told(ray);
  landmark.host = static_cast<std::int8_t>(host);
  landmark.prior = inverse_depth;
  landmark.prior_sigma = landmark.sigma = sigma;
  const int slot = graph_.add_landmark(landmark);
  if (slot < 0) return slot;
  solution_.rho[slot] = inverse_depth;
  start_.add_landmark(slot, inverse_depth);
  return slot;
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::finish_keyframe(bool moved) {
  graph_.forget_unused();
  moved_ += moved ? 1 : 0;
  if (started() < 2) return;
  left_ = parameters_.iterations;
  if (moved && !settled()) start_.begin();
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::forget_outliers() {
  for (int slot = 0; slot < kLandmarks; ++slot) {
    Landmark& landmark = graph_.landmark(slot);
    if (!landmark.used) continue;
    int seen = 0;
    int bad = 0;
    for (const std::int8_t place : graph_.places()) {
      const int pose = graph_.pose_of(place);
      if (pose == landmark.host || !landmark.seen_at(place)) continue;
      ++seen;
      Vector2<T> expected;
      const T limit = parameters_.outlier_sigma * parameters_.sigma;
      if (project(slot, solution_.pose[pose], expected) &&
          (graph_.observed(place, slot) - solution_.as_told(expected)).squaredNorm() <=
              limit * limit) {
        continue;
      }
      ++bad;
      const unsigned flag = 1U << static_cast<unsigned>(place);
      landmark.seen = static_cast<std::uint8_t>(landmark.seen & ~flag);
      landmark.doubted = static_cast<std::uint8_t>(landmark.doubted | flag);
    }
    if (bad > 1 && 2 * bad > seen) landmark.live = false;
  }
}

template <class T, class Bounds>
WindowSighting<T> KeyframeWindow<T, Bounds>::sighting(int slot) const {
  const Landmark& landmark = graph_.landmark(slot);
  const Rigid<T> T_world_host = solution_.pose[landmark.host].inverse();
  WindowSighting<T> s;
  s.rho = solution_.rho[slot];
  s.sigma = landmark.sigma;
  s.host = T_world_host.translation;
  const Vector2<T> ray = solution_.as_estimated(landmark.ray);
  s.direction = T_world_host.rotation * Vector3<T>(ray.x(), ray.y(), T(1)) + s.rho * s.host;
  return s;
}

template <class T, class Bounds>
bool KeyframeWindow<T, Bounds>::project(int slot, const Rigid<T>& T_camera_world,
                                        Vector2<T>& seen) const {
  InverseDepthView<T> view;
  if (!graph_.view(solution_, slot, T_camera_world, view)) return false;
  seen = view.seen;
  return true;
}

template <class T, class Bounds>
Vector3<T> KeyframeWindow<T, Bounds>::position(int slot) const {
  const WindowSighting<T> s = sighting(slot);
  return s.direction / s.rho;
}

template <class T, class Bounds>
T KeyframeWindow<T, Bounds>::typical_inverse_depth(const Rigid<T>& T_camera_world) const {
  constexpr int kFew = 8;
  constexpr T kKnown = T(0.3);
  FixedVector<T, kLandmarks> values;
  for (int slot = 0; slot < kLandmarks; ++slot) {
    const T rho = solution_.rho[slot];
    if (!live(slot) || !(sigma(slot) < kKnown * rho)) continue;
    InverseDepthView<T> view;
    if (graph_.view(solution_, slot, T_camera_world, view)) values.push_back(rho / view.p.z());
  }
  return values.size() < kFew ? T(0) : sort_for_median(values);
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::hash(Hash64& hash) const {
  for (const std::int8_t place : graph_.places()) {
    const Rigid<T>& pose = solution_.pose[graph_.pose_of(place)];
    for (int i = 0; i < 4; ++i) hash.add(pose.rotation.coeffs()(i));
    for (int i = 0; i < 3; ++i) hash.add(pose.translation(i));
  }
  for (int slot = 0; slot < kLandmarks; ++slot) {
    if (!used(slot)) continue;
    hash.add(id(slot));
    hash.add(inverse_depth(slot));
    hash.add(sigma(slot));
  }
}

}  // namespace cairn
