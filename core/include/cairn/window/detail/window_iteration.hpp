#pragma once

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/window/keyframe_window.hpp"

namespace cairn {

/// A pose that is fixed follows the focal length.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::move_fixed(const int* states, T focal_step,
                                           Solution& solution) const {
  bool free[kPoses] = {};
  for (const std::int8_t place : order_) free[slot_of_[place]] = states[place] >= 0;
  for (int pose = 0; pose < kPoses; ++pose) {
    if (free[pose] || !pose_used_[pose]) continue;
    const Vector<T, 6> step = focal_step * by_focal_[pose];
    solution.pose[pose] = perturbed(solution.pose[pose], step.data());
  }
}

/// One step of Levenberg and Marquardt. True where it lowered the cost.
template <class T, class Bounds>
bool KeyframeWindow<T, Bounds>::iterate(Solution& solution, T& damping, T& before, T& cost) {
  constexpr T kLeastDamping = T(1e-6);
  constexpr T kLeastRho = T(1e-3);
  constexpr T kLeastFocal = T(0.4);
  constexpr T kMostFocal = T(2.5);
  int states[kKeyframes] = {};
  number_states(states);
  before = cost = build(solution, states);
  T step[kMaxStates] = {};
  solved_ = solve_with_landmarks(system_, gradient_, reduced_, kLandmarks, damping, reduced_system_,
                                 step);
  if (!solved_) {
    damping *= T(10);
    return false;
  }
  Solution& trial = trial_;
  trial = solution;
  for (const std::int8_t place : order_) {
    if (states[place] < 0) continue;
    const int pose = slot_of_[place];
    trial.pose[pose] = perturbed(solution.pose[pose], step + states[place]);
  }
  const int count = system_.size();
  if (estimates_focal()) {
    const T focal = clamp(solution.focal + step[count - 1], kLeastFocal, kMostFocal);
    move_fixed(states, focal - solution.focal, trial);
    trial.focal = focal;
  }
  for (int slot = 0; slot < kLandmarks; ++slot) {
    const Reduced& reduced = reduced_[slot];
    if (!reduced.used) continue;
    const T rho = solution.rho[slot] + reduced.step(step, count, damping);
    trial.rho[slot] = rho > kLeastRho ? rho : kLeastRho;
  }
  const T lowered = cost_of(trial);
  if (!(lowered <= cost)) {
    damping *= T(10);
    return false;
  }
  solution = trial;
  cost = lowered;
  damping = damping > T(10) * kLeastDamping ? T(0.1) * damping : kLeastDamping;
  return true;
}

template <class T, class Bounds>
int KeyframeWindow<T, Bounds>::step_work() const {
  if (start_ == Start::kJudge) return kJudgeStart;
  if (start_ == Start::kSeek) return kSeekStart;
  if (start_ == Start::kTake) {
    return kTakeStart + kStartPose * (order_.size() - 2 - start_from_);
  }
  int landmarks = 0;
  int observations = 0;
  int pairs = 0;
  std::uint8_t seen[kPoses] = {};  // of a host's landmarks, a bit per place
  for (const Landmark& landmark : landmarks_) {
    if (!landmark.used) continue;
    ++landmarks;
    observations += observers(landmark);
    const unsigned more = landmark.seen & ~static_cast<unsigned>(seen[landmark.host]);
    for (int place = 0; place < kKeyframes; ++place) {
      pairs += static_cast<int>((more >> place) & 1U);
    }
    seen[landmark.host] = static_cast<std::uint8_t>(seen[landmark.host] | landmark.seen);
  }
  const int states = pose_states() + (estimates_focal() ? 1 : 0);
  const int squared = states * states;
  const int units = kStepBase + kStepPair * pairs + kStepTenObservations * observations / 10 +
                    landmarks * squared / kStatesSquaredInUnit +
                    squared * states / kStatesCubedInUnit;
  return compared_ ? units : 2 * units;  // the last one compares two solutions
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::step() {
  if (start_ == Start::kJudge) {
    judge_start();
  } else if (start_ == Start::kSeek) {
    seek_start();
  } else if (start_ == Start::kTake) {
    take_start();
  } else if (left_ > 0) {
    improve();
  }
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::improve() {
  constexpr T kSmall = T(1e-4);  // of the cost
  const bool first = left_ == parameters_.iterations;
  if (first) damping_ = kFirstDamping;
  T cost = T(0);
  T before = T(0);
  const bool lowered = iterate(now(), damping_, before, cost);
  --left_;
  if (lowered && before - cost < kSmall * before) left_ = 0;
  if (left_ > 0) return;
  if (!compared_) {
    compare_start();
    if (left_ > 0) return;
  }
  assess();
  forget_outliers();
}

/// What the observations say of each depth, the poses known, and of the newest keyframe's pose.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::assess() {
  for (int slot = 0; slot < kLandmarks; ++slot) {
    if (!reduced_[slot].used || !landmarks_[slot].used) continue;
    Landmark& landmark = landmarks_[slot];
    const T own = parameters_.sigma_factor / sqrt(reduced_[slot].information);
    landmark.sigma = own < landmark.prior_sigma ? own : landmark.prior_sigma;
  }
  if (estimates_focal() && solved_) assess_focal();
  // The last block of L D L^T is that of the newest pose, all others eliminated.
  const int count = pose_states();
  if (count < 6 || !solved_) return;
  Matrix<T, 6, 6> information;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c <= r; ++c) {
      T sum = T(0);
      for (int k = 0; k <= c; ++k) {
        const T* const d = reduced_system_.row(count - 6 + k) + count - 6;
        const T left = k == r ? T(1) : reduced_system_.row(count - 6 + r)[count - 6 + k];
        const T right = k == c ? T(1) : reduced_system_.row(count - 6 + c)[count - 6 + k];
        sum += left * right * d[k];
      }
      information(r, c) = sum;
    }
  }
  Matrix<T, 6, 6> covariance;
  if (!detail::invert_spd(information, T(1e-7), covariance)) return;
  newest_covariance_ = covariance;
}

/// The last element of L D L^T is the focal length's information, all others eliminated; its last
/// row says how the others follow from the focal length.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::assess_focal() {
  const int count = pose_states();
  const T* const last = reduced_system_.row(count);
  const T seen = last[count] > focal_weight() ? last[count] - focal_weight() : T(0);
  focal_excess_ = square(parameters_.focal_factor) + square(parameters_.focal_window_sigma) * seen;
  const T information = belief_.information() + seen / focal_excess_;
  focal_sigma_ = T(1) / sqrt(information);
  unsigned places = 0;
  for (const std::int8_t place : order_) places |= 1U << static_cast<unsigned>(place);
  belief_.note(now().focal, information, places);
  T follows[kMaxStates];
  for (int i = count - 1; i >= 0; --i) {
    follows[i] = -last[i];
    for (int k = i + 1; k < count; ++k) follows[i] -= reduced_system_.row(k)[i] * follows[k];
  }
  int states[kKeyframes] = {};
  number_states(states);
  for (const std::int8_t place : order_) {
    if (states[place] < 0) continue;
    for (int r = 0; r < 6; ++r) by_focal_[slot_of_[place]](r) = follows[states[place] + r];
  }
}

}  // namespace cairn
