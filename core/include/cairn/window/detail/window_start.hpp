#pragma once

#include "cairn/numeric/median.hpp"
#include "cairn/window/keyframe_window.hpp"

namespace cairn {

template <class T, class Bounds>
EpipolarOptions<T> KeyframeWindow<T, Bounds>::start_options() const {
  EpipolarOptions<T> options;
  options.sigma = parameters_.sigma / now().focal;
  options.huber_sigma = parameters_.huber_sigma;
  return options;
}

/// What the keyframe at `place` and the newest both see, doubted or not.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::common_view(int place, StartView& view) const {
  const int newest_place = order_.back();
  view.pairs.clear();
  for (int slot = 0; slot < kLandmarks && !view.pairs.full(); ++slot) {
    const Landmark& landmark = landmarks_[slot];
    const unsigned seen = landmark.seen | landmark.doubted;
    if (!landmark.used || ((seen >> place) & 1) == 0 || ((seen >> newest_place) & 1) == 0) continue;
    view.slots[view.pairs.size()] = slot;
    view.pairs.push_back(
        {as_estimated(observed_[place][slot]), as_estimated(observed_[newest_place][slot])});
  }
}

/// What the window's motion since the oldest keyframe that sees enough of the same leaves
/// unexplained; whether another could explain clearly more.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::judge_start() {
  start_ = Start::kNoCheck;
  StartView view;
  start_from_ = 0;
  for (; start_from_ + 1 < order_.size(); ++start_from_) {
    common_view(order_[start_from_], view);
    if (view.pairs.size() >= kLeastStartPairs) break;
  }
  if (start_from_ + 1 >= order_.size()) return;
  Rigid<T> believed = newest_pose() * now().pose[slot_of_[order_[start_from_]]].inverse();
  start_cost_ =
      improve_epipolar_motion(view.pairs.begin(), view.pairs.size(), start_options(), believed);
  if (parameters_.start_gain * start_cost_ > parameters_.start_margin) start_ = Start::kSeek;
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::seek_start() {
  start_ = Start::kNoCheck;
  StartView view;
  common_view(order_[start_from_], view);
  T cost = T(0);
  if (estimate_epipolar_motion(view.pairs.begin(), view.pairs.size(), start_options(),
                               start_motion_, cost) &&
      cost < parameters_.start_gain * start_cost_ - parameters_.start_margin) {
    start_ = Start::kTake;
  }
}

/// Poses and depths from the start's motion; the scale stays.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::take_start() {
  start_ = Start::kNoCheck;
  StartView view;
  common_view(order_[start_from_], view);
  T rho[kStartPairs];
  const T typical = start_depths(view, rho);
  if (!(typical > T(0))) return;
  for (Landmark& landmark : landmarks_) {
    landmark.seen = static_cast<std::uint8_t>(landmark.seen | landmark.doubted);
    landmark.doubted = 0;
  }
  if (compared_) before_ = now();
  compared_ = false;
  start_poses(view, rho);
  start_hosts(view, rho, typical);
  ++corrected_;
}

/// Goes back to what was before the start was corrected, where that explains the keyframes better:
/// a plane, for one, shows two motions in two pictures.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::compare_start() {
  compared_ = true;
  if (cost_of(now()) < cost_of(before_)) return;
  now() = before_;
  ++corrected_;
  left_ = 1;
}

/// Inverse depths in the first of the two keyframes. Scales them, and the motion, to the median
/// that the window has of these landmarks, and returns that; 0, nothing changed, where too few are
/// in front of both.
template <class T, class Bounds>
T KeyframeWindow<T, Bounds>::start_depths(const StartView& view, T* rho) {
  const Rigid<T>& first = now().pose[slot_of_[order_[start_from_]]];
  FixedVector<T, kStartPairs> found;
  FixedVector<T, kStartPairs> known;
  for (int i = 0; i < view.pairs.size(); ++i) {
    rho[i] = triangulate_inverse_depth(view.pairs[i], start_motion_);
    if (rho[i] > T(0)) found.push_back(rho[i]);
    const T depth = inverse_depth_in(view.slots[i], first);
    if (depth > T(0)) known.push_back(depth);
  }
  if (2 * found.size() < kLeastStartPairs || known.empty()) return T(0);
  const T typical = sort_for_median(known);
  const T scale = typical / sort_for_median(found);
  start_motion_.translation *= T(1) / scale;
  for (int i = 0; i < view.pairs.size(); ++i) {
    rho[i] = clamp(scale * rho[i], typical / kStartRange, typical * kStartRange);
  }
  return typical;
}

/// The newest keyframe from the motion, those between from the landmarks as they are known now.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::start_poses(const StartView& view, const T* rho) {
  constexpr T kSigma = T(0.2);  // of a depth, relative
  constexpr int kFewest = 8;
  const Rigid<T> first = now().pose[slot_of_[order_[start_from_]]];
  const Rigid<T> T_world_first = first.inverse();
  const int last = order_.size() - 1;
  now().pose[newest()] = start_motion_ * first;
  const Vector3<T> turn = rotation_log(start_motion_.rotation);
  WindowPoseOptions<T> options;
  options.sigma = parameters_.sigma / now().focal;
  options.max_iterations = 5;
  for (int index = start_from_ + 1; index < last; ++index) {
    const int place = order_[index];
    WindowSighting<T> sightings[kStartPairs];
    int count = 0;
    for (int i = 0; i < view.pairs.size(); ++i) {
      const int slot = view.slots[i];
      if (((landmarks_[slot].seen >> place) & 1) == 0) continue;
      const Vector2<T>& direction = view.pairs[i].first;
      WindowSighting<T>& s = sightings[count++];
      s.rho = rho[i];
      s.sigma = kSigma * rho[i];
      s.host = T_world_first.translation;
      s.direction =
          T_world_first.rotation * Vector3<T>(direction.x(), direction.y(), T(1)) + s.rho * s.host;
      s.seen = as_estimated(observed_[place][slot]);
    }
    const T part = static_cast<T>(index - start_from_) / static_cast<T>(last - start_from_);
    Rigid<T> between;
    between.rotation = rotation_exp(Vector3<T>(part * turn));
    between.translation = part * start_motion_.translation;
    Rigid<T> pose = between * first;
    Matrix<T, 6, 6> covariance;
    if (count >= kFewest) {
      static_cast<void>(estimate_window_pose(sightings, count, options, pose, covariance));
    }
    now().pose[slot_of_[place]] = pose;
  }
}

/// Depths of all landmarks in their hosts: of those of the view from it, of others from where the
/// keyframe farthest from the host sees them.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::start_hosts(const StartView& view, const T* rho, T typical) {
  constexpr T kNear = InverseDepthView<T>::kLeastDepth;
  const Rigid<T> T_world_first = now().pose[slot_of_[order_[start_from_]]].inverse();
  bool done[kLandmarks] = {};
  for (int i = 0; i < view.pairs.size(); ++i) {
    const int slot = view.slots[i];
    const Rigid<T> to_host = now().pose[landmarks_[slot].host] * T_world_first;
    const Vector2<T>& direction = view.pairs[i].first;
    const Vector3<T> p = to_host.rotation * Vector3<T>(direction.x(), direction.y(), T(1)) +
                         rho[i] * to_host.translation;
    now().rho[slot] = rho[i] / (p.z() > kNear ? p.z() : kNear);
    done[slot] = true;
  }
  for (int slot = 0; slot < kLandmarks; ++slot) {
    const Landmark& landmark = landmarks_[slot];
    const int host_place = landmark.used ? place_of(landmark.host) : -1;
    if (done[slot] || host_place < 0) continue;
    const Rigid<T> T_world_host = now().pose[landmark.host].inverse();
    T farthest = T(0);
    for (const std::int8_t place : order_) {
      if (place == host_place || ((landmark.seen >> place) & 1) == 0) continue;
      const Rigid<T> moved = now().pose[slot_of_[place]] * T_world_host;
      const T distance = moved.translation.squaredNorm();
      if (!(distance > farthest)) continue;
      farthest = distance;
      const DirectionPair<T> pair{as_estimated(landmark.ray), as_estimated(observed_[place][slot])};
      now().rho[slot] = clamp(triangulate_inverse_depth(pair, moved), typical / kStartRange,
                              typical * kStartRange);
    }
  }
}

}  // namespace cairn
