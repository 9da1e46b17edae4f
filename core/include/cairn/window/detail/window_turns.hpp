#pragma once

#include "cairn/window/detail/window_cost.hpp"
#include "cairn/window/keyframe_window.hpp"

namespace cairn {

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::set_turn(const Quaternion<T>& R_before_newest, T variance) {
  if (order_.size() < 2) return;
  Turn& turn = turns_[order_.back()];
  turn.known = true;
  turn.rotation = R_before_newest.conjugate();
  turn.variance = variance;
}

/// Before the keyframe at an index leaves: the one after it follows the one before it.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::join_turns(int index) {
  if (index + 1 >= order_.size()) return;
  const Turn& leaving = turns_[order_[index]];
  Turn& after = turns_[order_[index + 1]];
  after.known = after.known && leaving.known && index > 0;
  if (!after.known) return;
  after.rotation = after.rotation * leaving.rotation;
  after.variance += leaving.variance;
}

/// What a solution leaves of a keyframe's turn, in its axes; `distance`: in sigmas.
template <class T, class Bounds>
Vector3<T> KeyframeWindow<T, Bounds>::turn_left(const Solution& solution, int index,
                                                T& distance) const {
  const Turn& turn = turns_[order_[index]];
  const Quaternion<T>& before = solution.pose[slot_of_[order_[index - 1]]].rotation;
  const Quaternion<T>& present = solution.pose[slot_of_[order_[index]]].rotation;
  const Vector3<T> left = rotation_log(turn.rotation * before * present.conjugate());
  distance = sqrt(left.squaredNorm() / turn.variance);
  return left;
}

/// R_measured = Exp(left) R_present R_before^T: a small turn of the present pose takes from what is
/// left, one of the pose before adds it, turned into the present axes. Poses that are fixed do so
/// as they follow the focal length.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::add_turn(const Solution& solution, int index, const int* states,
                                         T& cost) {
  const int place = order_[index];
  const int place_before = order_[index - 1];
  const int state = states[place];
  const int state_before = states[place_before];
  T distance = T(0);
  const Vector3<T> left = turn_left(solution, index, distance);
  cost += detail::window_cost(distance, parameters_.huber_sigma);
  const T robust = distance < parameters_.huber_sigma ? T(1) : parameters_.huber_sigma / distance;
  const T weight = robust / turns_[place].variance;
  const Matrix3<T> across = (solution.pose[slot_of_[place]].rotation *
                             solution.pose[slot_of_[place_before]].rotation.conjugate())
                                .toRotationMatrix();
  const Vector3<T> back = across.transpose() * left;
  for (int r = 0; r < 3; ++r) {
    system_(state + r, state + r) += weight;
    gradient_[state + r] += weight * left(r);
    if (state_before < 0) continue;
    system_(state_before + r, state_before + r) += weight;
    gradient_[state_before + r] -= weight * back(r);
    for (int c = 0; c < 3; ++c) system_(state + r, state_before + c) -= weight * across(r, c);
  }
  if (!estimates_focal() || state_before >= 0) return;
  const int focal_state = pose_states();
  const Vector3<T> follows = -(across * by_focal_[slot_of_[place_before]].template head<3>());
  system_(focal_state, focal_state) += weight * follows.squaredNorm();
  gradient_[focal_state] += weight * follows.dot(left);
  for (int r = 0; r < 3; ++r) system_(focal_state, state + r) += weight * follows(r);
}

}  // namespace cairn
