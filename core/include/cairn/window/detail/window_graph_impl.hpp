#pragma once

#include "cairn/window/window_graph.hpp"

namespace cairn {

template <class T, class Bounds>
void WindowGraph<T, Bounds>::clear() {
  for (Landmark& landmark : landmarks_) landmark = Landmark();
  for (bool& used : pose_used_) used = false;
  order_.clear();
  started_ = 0;
}

template <class T, class Bounds>
int WindowGraph<T, Bounds>::place_of(int pose) const {
  for (const std::int8_t place : order_) {
    if (slot_of_[place] == pose) return place;
  }
  return -1;
}

template <class T, class Bounds>
int WindowGraph<T, Bounds>::free_place() const {
  bool taken[kKeyframes] = {};
  for (const std::int8_t place : order_) taken[place] = true;
  int place = 0;
  while (taken[place]) ++place;
  return place;
}

template <class T, class Bounds>
int WindowGraph<T, Bounds>::take_pose() {
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
  return best;
}

template <class T, class Bounds>
int WindowGraph<T, Bounds>::add_keyframe() {
  const int place = free_place();
  const int pose = take_pose();
  slot_of_[place] = static_cast<std::int8_t>(pose);
  turns_[place].known = false;
  order_.push_back(static_cast<std::int8_t>(place));
  ++started_;
  return pose;
}

template <class T, class Bounds>
void WindowGraph<T, Bounds>::drop(int index) {
  const auto flag = static_cast<std::uint8_t>(1U << static_cast<unsigned>(order_[index]));
  for (Landmark& landmark : landmarks_) {
    landmark.seen = static_cast<std::uint8_t>(landmark.seen & ~flag);
    landmark.doubted = static_cast<std::uint8_t>(landmark.doubted & ~flag);
  }
  join_turns(index);
  for (int i = index; i + 1 < order_.size(); ++i) order_[i] = order_[i + 1];
  order_.pop_back();
}

template <class T, class Bounds>
int WindowGraph<T, Bounds>::worst_keyframe(const Solution& solution, const Rigid<T>& newest) const {
  constexpr int kFew = 5;
  constexpr T kNear = T(1e-3);
  const int count = order_.size();
  Vector3<T> centre[kKeyframes];
  for (int i = 0; i < count; ++i) centre[i] = solution.pose[pose_at(i)].inverse().translation;
  const Vector3<T> here = newest.inverse().translation;
  int worst = 0;
  T most = T(-1);
  for (int i = 0; i + 1 < count; ++i) {
    int visible = 0;
    for (const Landmark& landmark : landmarks_) {
      visible += landmark.live && landmark.seen_at(order_[i]) ? 1 : 0;
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
void WindowGraph<T, Bounds>::set_turn(const Quaternion<T>& R_present_before, T variance) {
  if (order_.size() < 2) return;
  Turn& turn = turns_[order_.back()];
  turn.known = true;
  turn.rotation = R_present_before;
  turn.variance = variance;
}

/// Before the keyframe at an index leaves: the one after it follows the one before it.
template <class T, class Bounds>
void WindowGraph<T, Bounds>::join_turns(int index) {
  if (index + 1 >= order_.size()) return;
  const Turn& leaving = turns_[order_[index]];
  Turn& after = turns_[order_[index + 1]];
  after.known = after.known && leaving.known && index > 0;
  if (!after.known) return;
  after.rotation = after.rotation * leaving.rotation;
  after.variance += leaving.variance;
}

template <class T, class Bounds>
void WindowGraph<T, Bounds>::number_states(int* states) const {
  int next = 0;
  for (int i = 0; i < order_.size(); ++i) {
    states[order_[i]] = i < fixed() ? -1 : next;
    next += i < fixed() ? 0 : 6;
  }
}

template <class T, class Bounds>
int WindowGraph<T, Bounds>::add_landmark(const Landmark& landmark) {
  int slot = 0;
  while (slot < kLandmarks && landmarks_[slot].used) ++slot;
  if (slot == kLandmarks) return -1;
  landmarks_[slot] = landmark;
  landmarks_[slot].used = landmarks_[slot].live = true;
  return slot;
}

template <class T, class Bounds>
void WindowGraph<T, Bounds>::forget_unused() {
  for (Landmark& landmark : landmarks_) {
    if (landmark.used && !landmark.live && landmark.observers() < 2) landmark = Landmark();
  }
}

template <class T, class Bounds>
void WindowGraph<T, Bounds>::trust_doubted() {
  for (Landmark& landmark : landmarks_) {
    landmark.seen = static_cast<std::uint8_t>(landmark.seen | landmark.doubted);
    landmark.doubted = 0;
  }
}

template <class T, class Bounds>
typename WindowGraph<T, Bounds>::Hosted WindowGraph<T, Bounds>::hosted_by(int host) const {
  Hosted hosted;
  for (int slot = 0; slot < kLandmarks; ++slot) {
    const Landmark& landmark = landmarks_[slot];
    if (landmark.host != host) continue;
    hosted.slots[hosted.count++] = static_cast<std::int16_t>(slot);
    hosted.seen = static_cast<std::uint8_t>(hosted.seen | landmark.seen);
  }
  return hosted;
}

template <class T, class Bounds>
typename WindowGraph<T, Bounds>::Size WindowGraph<T, Bounds>::size() const {
  Size size;
  std::uint8_t seen[kPoses] = {};  // of a host's landmarks, a bit per place
  for (const Landmark& landmark : landmarks_) {
    if (!landmark.used) continue;
    ++size.landmarks;
    size.observations += landmark.observers();
    const unsigned more = landmark.seen & ~static_cast<unsigned>(seen[landmark.host]);
    for (int place = 0; place < kKeyframes; ++place) {
      size.pairs += static_cast<int>((more >> place) & 1U);
    }
    seen[landmark.host] = static_cast<std::uint8_t>(seen[landmark.host] | landmark.seen);
  }
  return size;
}

template <class T, class Bounds>
void WindowGraph<T, Bounds>::observe(int slot, const Vector2<T>& told) {
  const int place = order_.back();
  observed_[place][slot] = told;
  Landmark& landmark = landmarks_[slot];
  landmark.seen = static_cast<std::uint8_t>(landmark.seen | (1U << static_cast<unsigned>(place)));
}

template <class T, class Bounds>
void WindowGraph<T, Bounds>::doubt(int slot, const Vector2<T>& told) {
  const int place = order_.back();
  observed_[place][slot] = told;
  Landmark& landmark = landmarks_[slot];
  landmark.doubted =
      static_cast<std::uint8_t>(landmark.doubted | (1U << static_cast<unsigned>(place)));
}

template <class T, class Bounds>
void WindowGraph<T, Bounds>::amend(int slot, const Vector2<T>& told) {
  const int place = order_.back();
  Landmark& landmark = landmarks_[slot];
  if (!landmark.used || !landmark.shown_at(place)) return;
  observed_[place][slot] = told;
  if (landmark.host == newest()) landmark.ray = told;
}

}  // namespace cairn
