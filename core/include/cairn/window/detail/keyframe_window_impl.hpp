#pragma once

#include "cairn/numeric/median.hpp"
#include "cairn/window/keyframe_window.hpp"

namespace cairn {

template <class T, class Bounds>
Status KeyframeWindow<T, Bounds>::initialise(const Parameters& parameters) {
  const Status status = parameters.validate();
  if (!ok(status)) return status;
  parameters_ = parameters;
  belief_.reset(parameters.focal_sigma);
  focal_sigma_ = parameters.focal_sigma;
  clear();
  return Status::kOk;
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::clear() {
  for (Landmark& landmark : landmarks_) landmark = Landmark();
  for (bool& used : pose_used_) used = false;
  order_.clear();
  belief_.leave_all();
  focal_excess_ = square(parameters_.focal_factor);
  solution_.focal = belief_.mean();
  for (Vector<T, 6>& by_focal : by_focal_) by_focal.setZero();
  started_ = moved_ = corrected_ = left_ = 0;
  start_ = Start::kNoCheck;
  compared_ = true;
  anchored_ = false;
  solved_ = false;
  newest_covariance_.setZero();
}

/// The place of a pose in the window, -1 for a host that has left it.
template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::place_of(int pose) const {
  for (const std::int8_t place : order_) {
    if (slot_of_[place] == pose) return place;
  }
  return -1;
}

template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::free_place() {
  bool taken[kKeyframes] = {};
  for (const std::int8_t place : order_) taken[place] = true;
  int place = 0;
  while (taken[place]) ++place;
  return place;
}

/// With none free, the host outside the window with the fewest landmarks is given up, and they with
/// it.
template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::free_pose() {
  int hosted[kPoses] = {};
  for (const Landmark& landmark : landmarks_) {
    if (landmark.used) ++hosted[landmark.host];
  }
  int best = -1;
  for (int pose = 0; pose < kPoses; ++pose) {
    if (place_of(pose) >= 0) continue;
    if (best < 0 || hosted[pose] < hosted[best]) best = pose;
  }
  for (Landmark& landmark : landmarks_) {
    if (landmark.used && landmark.host == best) landmark = Landmark();
  }
  pose_used_[best] = true;
  by_focal_[best].setZero();
  return best;
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::drop(int index) {
  const auto flag = static_cast<std::uint8_t>(1U << static_cast<unsigned>(order_[index]));
  for (Landmark& landmark : landmarks_) {
    landmark.seen = static_cast<std::uint8_t>(landmark.seen & ~flag);
    landmark.doubted = static_cast<std::uint8_t>(landmark.doubted & ~flag);
  }
  belief_.leave(order_[index]);
  join_turns(index);
  for (int i = index; i + 1 < order_.size(); ++i) order_[i] = order_[i + 1];
  order_.pop_back();
}

/// Index of the keyframe to drop before one at `newest`: one that sees next to nothing of what is
/// followed, else the one with the largest distance score. The newest stays.
template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::worst_keyframe(const Rigid<T>& newest) const {
  constexpr int kFew = 5;
  constexpr T kNear = T(1e-3);
  const int count = order_.size();
  Vector3<T> centre[kKeyframes];
  for (int i = 0; i < count; ++i) {
    centre[i] = now().pose[slot_of_[order_[i]]].inverse().translation;
  }
  const Vector3<T> here = newest.inverse().translation;
  int worst = 0;
  T most = T(-1);
  for (int i = 0; i + 1 < count; ++i) {
    int visible = 0;
    for (const Landmark& landmark : landmarks_) {
      visible += landmark.live && ((landmark.seen >> order_[i]) & 1) != 0 ? 1 : 0;
    }
    if (visible < kFew) return i;
    T score = T(1) / (sqrt((centre[i] - here).squaredNorm()) + kNear);
    for (int j = 0; j < count; ++j) {
      if (j != i) score += T(1) / (sqrt((centre[i] - centre[j]).squaredNorm()) + kNear);
    }
    score *= sqrt(sqrt((centre[i] - here).squaredNorm()) + T(1e-6));
    if (score > most) {
      most = score;
      worst = i;
    }
  }
  return worst;
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::begin_keyframe(const Rigid<T>& T_camera_world) {
  if (order_.full()) drop(worst_keyframe(T_camera_world));
  const int last = order_.empty() ? -1 : newest();
  const int place = free_place();
  const int pose = free_pose();
  slot_of_[place] = static_cast<std::int8_t>(pose);
  turns_[place].known = false;
  order_.push_back(static_cast<std::int8_t>(place));
  ++started_;
  new_depth_ = T(0);
  now().pose[pose] = T_camera_world;
  start_ = Start::kNoCheck;
  if (last >= 0) {
    before_.pose[pose] = T_camera_world * now().pose[last].inverse() * before_.pose[last];
  }
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::observe(int slot, const Vector2<T>& seen) {
  const int place = order_.back();
  observed_[place][slot] = as_told(seen);
  Landmark& landmark = landmarks_[slot];
  landmark.seen = static_cast<std::uint8_t>(landmark.seen | (1U << static_cast<unsigned>(place)));
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::doubt(int slot, const Vector2<T>& seen) {
  const int place = order_.back();
  observed_[place][slot] = as_told(seen);
  Landmark& landmark = landmarks_[slot];
  landmark.doubted =
      static_cast<std::uint8_t>(landmark.doubted | (1U << static_cast<unsigned>(place)));
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::amend(int slot, const Vector2<T>& seen) {
  const int place = order_.back();
  Landmark& landmark = landmarks_[slot];
  if (!landmark.used || (((landmark.seen | landmark.doubted) >> place) & 1) == 0) return;
  observed_[place][slot] = as_told(seen);
  if (landmark.host == newest()) landmark.ray = observed_[place][slot];
}

template <class T, class Bounds>
bool KeyframeWindow<T, Bounds>::newest_sees(int slot, Vector2<T>& seen) const {
  const int place = order_.back();
  if (!landmarks_[slot].used || ((landmarks_[slot].seen >> place) & 1) == 0) return false;
  seen = as_estimated(observed_[place][slot]);
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
  const int pose = free_pose();
  now().pose[pose] = before_.pose[pose] = T_camera_world;
  anchored_ = anchored_ || started_ == 1;
  return pose;
}

template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::add_known_landmark(LandmarkId id, int host, const Vector2<T>& ray,
                                                  T inverse_depth, T sigma) {
  int slot = 0;
  while (slot < kLandmarks && landmarks_[slot].used) ++slot;
  if (slot == kLandmarks) return -1;
  Landmark& landmark = landmarks_[slot];
  landmark = Landmark();
  landmark.id = id;
  landmark.ray = as_told(ray);
  landmark.host = static_cast<std::int8_t>(host);
  landmark.prior = inverse_depth;
  landmark.prior_sigma = sigma;
  landmark.sigma = sigma;
  landmark.used = landmark.live = true;
  now().rho[slot] = before_.rho[slot] = landmark.prior;
  return slot;
}

template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::observers(const Landmark& landmark) const {
  int count = 0;
  for (int place = 0; place < kKeyframes; ++place) count += (landmark.seen >> place) & 1;
  return count;
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::forget_unused() {
  for (Landmark& landmark : landmarks_) {
    if (landmark.used && !landmark.live && observers(landmark) < 2) landmark = Landmark();
  }
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::finish_keyframe(bool moved) {
  forget_unused();
  moved_ += moved ? 1 : 0;
  if (started_ < 2) return;
  left_ = parameters_.iterations;
  if (moved && !settled()) start_ = Start::kJudge;
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::forget_outliers() {
  for (int slot = 0; slot < kLandmarks; ++slot) {
    Landmark& landmark = landmarks_[slot];
    if (!landmark.used) continue;
    int seen = 0;
    int bad = 0;
    for (const std::int8_t place : order_) {
      const int pose = slot_of_[place];
      if (pose == landmark.host || ((landmark.seen >> place) & 1) == 0) continue;
      ++seen;
      Vector2<T> expected;
      const T limit = parameters_.outlier_sigma * parameters_.sigma;
      if (project(slot, now().pose[pose], expected) &&
          (observed_[place][slot] - as_told(expected)).squaredNorm() <= limit * limit) {
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
  const Landmark& landmark = landmarks_[slot];
  const Rigid<T> T_world_host = now().pose[landmark.host].inverse();
  WindowSighting<T> s;
  s.rho = now().rho[slot];
  s.sigma = landmark.sigma;
  s.host = T_world_host.translation;
  const Vector2<T> ray = as_estimated(landmark.ray);
  s.direction = T_world_host.rotation * Vector3<T>(ray.x(), ray.y(), T(1)) + s.rho * s.host;
  return s;
}

template <class T, class Bounds>
bool KeyframeWindow<T, Bounds>::project(int slot, const Rigid<T>& T_camera_world,
                                        Vector2<T>& seen) const {
  InverseDepthView<T> view;
  const CameraStep<T> step(now().pose[landmarks_[slot].host], T_camera_world);
  if (!view.project(step, as_estimated(landmarks_[slot].ray), now().rho[slot])) return false;
  seen = view.seen;
  return true;
}

template <class T, class Bounds>
T KeyframeWindow<T, Bounds>::inverse_depth_in(int slot, const Rigid<T>& T_camera_world) const {
  InverseDepthView<T> view;
  const CameraStep<T> step(now().pose[landmarks_[slot].host], T_camera_world);
  if (!view.project(step, as_estimated(landmarks_[slot].ray), now().rho[slot])) return T(0);
  return now().rho[slot] / view.p.z();
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
    const T rho = now().rho[slot];
    if (!live(slot) || !(landmarks_[slot].sigma < kKnown * rho)) continue;
    InverseDepthView<T> view;
    const CameraStep<T> step(now().pose[landmarks_[slot].host], T_camera_world);
    if (!view.project(step, as_estimated(landmarks_[slot].ray), rho)) continue;
    values.push_back(rho / view.p.z());
  }
  return values.size() < kFew ? T(0) : sort_for_median(values);
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::hash(Hash64& hash) const {
  for (const std::int8_t place : order_) {
    const Rigid<T>& pose = now().pose[slot_of_[place]];
    for (int i = 0; i < 4; ++i) hash.add(pose.rotation.coeffs()(i));
    for (int i = 0; i < 3; ++i) hash.add(pose.translation(i));
  }
  for (int slot = 0; slot < kLandmarks; ++slot) {
    if (!landmarks_[slot].used) continue;
    hash.add(landmarks_[slot].id);
    hash.add(now().rho[slot]);
    hash.add(landmarks_[slot].sigma);
  }
}

}  // namespace cairn
