#pragma once

#include "cairn/window/keyframe_window.hpp"

namespace cairn {

/// One step of Levenberg and Marquardt. True where it lowered the cost.
template <class T, class Bounds>
bool KeyframeWindow<T, Bounds>::iterate(T& before, T& cost) {
  constexpr T kLeastDamping = T(1e-6);
  constexpr T kLeastRho = T(1e-3);
  constexpr T kLeastFocal = T(0.4);
  constexpr T kMostFocal = T(2.5);
  before = cost = equations_.build(problem(), solution_);
  T step[Graph::kMaxStates] = {};
  if (!equations_.solve(damping_, step)) {
    damping_ *= T(10);
    return false;
  }
  int states[kKeyframes] = {};
  graph_.number_states(states);
  trial_ = solution_;
  for (const std::int8_t place : graph_.places()) {
    if (states[place] < 0) continue;
    const int pose = graph_.pose_of(place);
    trial_.pose[pose] = perturbed(solution_.pose[pose], step + states[place]);
  }
  const int count = equations_.states();
  if (focal_.estimated(graph_)) {
    trial_.focal = clamp(solution_.focal + step[count - 1], kLeastFocal, kMostFocal);
    focal_.move_fixed(graph_, states, trial_.focal - solution_.focal, trial_);
  }
  for (int slot = 0; slot < kLandmarks; ++slot) {
    const auto& landmark = equations_.landmark(slot);
    if (!landmark.used) continue;
    const T rho = solution_.rho[slot] + landmark.step(step, count, damping_);
    trial_.rho[slot] = rho > kLeastRho ? rho : kLeastRho;
  }
  const T lowered = equations_.cost_of(problem(), trial_);
  if (!(lowered <= cost)) {
    damping_ *= T(10);
    return false;
  }
  solution_ = trial_;
  cost = lowered;
  damping_ = damping_ > T(10) * kLeastDamping ? T(0.1) * damping_ : kLeastDamping;
  return true;
}

template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::step_work() const {
  if (start_.pending()) return start_.step_work(graph_);
  const typename Graph::Size size = graph_.size();
  const int states = graph_.pose_states() + (focal_.estimated(graph_) ? 1 : 0);
  const int squared = states * states;
  const int units =
      kStepBase + kStepPair * size.pairs + kStepTenObservations * size.observations / 10 +
      size.landmarks * squared / kStatesSquaredInUnit + squared * states / kStatesCubedInUnit;
  return start_.compared() ? units : 2 * units;  // the last one compares two solutions
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::step() {
  if (start_.pending()) {
    start_.step(graph_, solution_, parameters_);
  } else if (left_ > 0) {
    improve();
  }
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::improve() {
  constexpr T kSmall = T(1e-4);  // of the cost
  if (left_ == parameters_.iterations) damping_ = kFirstDamping;
  T cost = T(0);
  T before = T(0);
  const bool lowered = iterate(before, cost);
  --left_;
  if (lowered && before - cost < kSmall * before) left_ = 0;
  if (left_ > 0) return;
  if (!start_.compared() &&
      start_.settle(equations_.cost_of(problem(), solution_, detail::kMismatch<T>),
                    equations_.cost_of(problem(), start_.before(), detail::kMismatch<T>),
                    solution_)) {
    left_ = 1;
    return;
  }
  assess();
  forget_outliers();
}

/// What the observations say of each depth, the poses known, of the focal length, and of the newest
/// keyframe's pose.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::assess() {
  for (int slot = 0; slot < kLandmarks; ++slot) {
    Landmark& landmark = graph_.landmark(slot);
    if (!equations_.landmark(slot).used || !landmark.used) continue;
    const T own = parameters_.sigma_factor / sqrt(equations_.landmark(slot).information);
    landmark.sigma = own < landmark.prior_sigma ? own : landmark.prior_sigma;
  }
  if (focal_.estimated(graph_) && equations_.solved()) {
    focal_.assess(graph_, equations_.factors(), solution_.focal, parameters_);
  }
  static_cast<void>(equations_.newest_covariance(graph_, newest_covariance_));
}

}  // namespace cairn
