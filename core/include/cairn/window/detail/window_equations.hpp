#pragma once

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/window/keyframe_window.hpp"

namespace cairn {

namespace detail {

/// Adjoint of a camera step T: Exp(a) T = T Exp(b) with a = Ad(T) b, in the order (phi, rho).
template <class T>
Matrix<T, 6, 6> adjoint(const CameraStep<T>& step) {
  Matrix<T, 6, 6> result = Matrix<T, 6, 6>::Zero();
  result.template topLeftCorner<3, 3>() = step.rotation;
  result.template bottomRightCorner<3, 3>() = step.rotation;
  result.template bottomLeftCorner<3, 3>() = skew(step.translation) * step.rotation;
  return result;
}

/// Huber's cost of a residual of `distance` sigmas.
template <class T>
T window_cost(T distance, T huber) {
  return distance < huber ? T(0.5) * distance * distance : huber * (distance - T(0.5) * huber);
}

/// Cost of an observation that has no direction in its keyframe.
template <class T>
inline constexpr T kHiddenCost = T(50);

}  // namespace detail

/// First state of each place's pose, -1 for those that are fixed.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::number_states(int* states) const {
  int next = 0;
  for (int i = 0; i < order_.size(); ++i) {
    states[order_[i]] = i < fixed() ? -1 : next;
    next += i < fixed() ? 0 : 6;
  }
}

template <class T, class Bounds>
T KeyframeWindow<T, Bounds>::prior_cost(const Solution& solution, int slot) const {
  const Landmark& landmark = landmarks_[slot];
  return T(0.5) * square((landmark.prior - solution.rho[slot]) / landmark.prior_sigma);
}

/// Adds what the keyframe at `place` saw of the landmarks of one host.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::add_pair(const Solution& solution, int host, int place,
                                         const int* states, T& cost) {
  const CameraStep<T> step(solution.pose[host], solution.pose[slot_of_[place]]);
  const Matrix<T, 6, 6> ad = detail::adjoint(step);
  const int host_place = place_of(host);
  const int target_state = states[place];
  const int host_state = host_place >= 0 ? states[host_place] : -1;
  const T per_sigma = T(1) / parameters_.sigma;
  Matrix<T, 6, 6> information = Matrix<T, 6, 6>::Zero();  // lower triangle
  Vector<T, 6> gradient = Vector<T, 6>::Zero();
  for (int slot = 0; slot < kLandmarks; ++slot) {
    const Landmark& landmark = landmarks_[slot];
    if (landmark.host != host || ((landmark.seen >> place) & 1) == 0) continue;
    InverseDepthView<T> view;
    const T rho = solution.rho[slot];
    if (!view.project(step, landmark.ray, rho)) {
      cost += detail::kHiddenCost<T>;
      continue;
    }
    const Vector2<T> residual = observed_[place][slot] - view.seen;
    const T distance = sqrt(residual.squaredNorm()) * per_sigma;
    cost += detail::window_cost(distance, parameters_.huber_sigma);
    const T robust = distance < parameters_.huber_sigma ? T(1) : parameters_.huber_sigma / distance;
    const T weight = robust * per_sigma * per_sigma;
    const InverseDepthJacobian<T> j(view, step.translation, rho);
    Vector<T, 6> by_depth;
    for (int r = 0; r < 6; ++r) {
      const T u = weight * j.by_pose[0][r];
      const T v = weight * j.by_pose[1][r];
      for (int c = 0; c <= r; ++c) information(r, c) += u * j.by_pose[0][c] + v * j.by_pose[1][c];
      gradient(r) += u * residual.x() + v * residual.y();
      by_depth(r) = u * j.by_depth[0] + v * j.by_depth[1];
    }
    Reduced& reduced = reduced_[slot];
    reduced.used = true;
    reduced.information += weight * (square(j.by_depth[0]) + square(j.by_depth[1]));
    reduced.gradient += weight * (j.by_depth[0] * residual.x() + j.by_depth[1] * residual.y());
    if (target_state >= 0) {
      for (int r = 0; r < 6; ++r) reduced.by_pose[target_state + r] += by_depth(r);
    }
    if (host_state >= 0) {
      for (int r = 0; r < 6; ++r) {
        T sum = T(0);
        for (int k = 0; k < 6; ++k) sum += ad(k, r) * by_depth(k);
        reduced.by_pose[host_state + r] -= sum;
      }
    }
  }
  for (int r = 0; r < 6; ++r) {
    for (int c = r + 1; c < 6; ++c) information(r, c) = information(c, r);
  }
  if (target_state >= 0) {
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c <= r; ++c) system_(target_state + r, target_state + c) += information(r, c);
      gradient_[target_state + r] += gradient(r);
    }
  }
  if (host_state < 0) return;
  // The host moves the landmark the other way, through the step between the two.
  const Matrix<T, 6, 6> across = information * ad;
  const Matrix<T, 6, 6> own = ad.transpose() * across;
  const Vector<T, 6> turned = ad.transpose() * gradient;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c <= r; ++c) system_(host_state + r, host_state + c) += own(r, c);
    gradient_[host_state + r] -= turned(r);
    if (target_state < 0) continue;
    for (int c = 0; c < 6; ++c) system_(target_state + r, host_state + c) -= across(r, c);
  }
}

/// Normal equations at a solution; returns its cost.
template <class T, class Bounds>
T KeyframeWindow<T, Bounds>::build(const Solution& solution, const int* states) {
  const int count = order_.size() > fixed() ? 6 * (order_.size() - fixed()) : 0;
  system_.resize(count);
  system_.set_zero();
  for (T& g : gradient_) g = T(0);
  bool hosts[kPoses] = {};
  for (int slot = 0; slot < kLandmarks; ++slot) {
    Reduced& reduced = reduced_[slot];
    reduced.clear(count);
    if (landmarks_[slot].used) hosts[landmarks_[slot].host] = true;
  }
  T cost = T(0);
  for (int host = 0; host < kPoses; ++host) {
    if (!hosts[host]) continue;
    for (const std::int8_t place : order_) {
      if (slot_of_[place] != host) add_pair(solution, host, place, states, cost);
    }
  }
  for (int slot = 0; slot < kLandmarks; ++slot) {
    Reduced& reduced = reduced_[slot];
    if (!reduced.used) continue;
    const Landmark& landmark = landmarks_[slot];
    const T information = T(1) / square(landmark.prior_sigma);
    cost += prior_cost(solution, slot);
    reduced.information += information;
    reduced.gradient += information * (landmark.prior - solution.rho[slot]);
  }
  return cost;
}

/// Cost over the landmarks that the last build() used.
template <class T, class Bounds>
T KeyframeWindow<T, Bounds>::cost_of(const Solution& solution) const {
  const T per_sigma = T(1) / parameters_.sigma;
  T cost = T(0);
  CameraStep<T> steps[kKeyframes];
  for (int host = 0; host < kPoses; ++host) {
    bool known = false;
    for (int slot = 0; slot < kLandmarks; ++slot) {
      const Landmark& landmark = landmarks_[slot];
      if (landmark.host != host) continue;
      if (!known) {
        for (const std::int8_t place : order_) {
          steps[place] = CameraStep<T>(solution.pose[host], solution.pose[slot_of_[place]]);
        }
        known = true;
      }
      if (reduced_[slot].used) cost += prior_cost(solution, slot);
      for (const std::int8_t place : order_) {
        if (slot_of_[place] == host || ((landmark.seen >> place) & 1) == 0) continue;
        InverseDepthView<T> view;
        if (!view.project(steps[place], landmark.ray, solution.rho[slot])) {
          cost += detail::kHiddenCost<T>;
          continue;
        }
        const Vector2<T> residual = observed_[place][slot] - view.seen;
        cost +=
            detail::window_cost(sqrt(residual.squaredNorm()) * per_sigma, parameters_.huber_sigma);
      }
    }
  }
  return cost;
}

/// One step of Levenberg and Marquardt. True where it lowered the cost.
template <class T, class Bounds>
bool KeyframeWindow<T, Bounds>::iterate(Solution& solution, T& damping, T& before, T& cost) {
  constexpr T kLeastDamping = T(1e-6);
  constexpr T kLeastRho = T(1e-3);
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
  int landmarks = 0;
  int observations = 0;
  for (const Landmark& landmark : landmarks_) {
    if (!landmark.used) continue;
    ++landmarks;
    observations += observers(landmark);
  }
  return kStepBase + kStepLandmark * landmarks + kStepObservation * observations;
}

template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::step() {
  if (left_ > 0) {
    improve();
  } else if (mirror_left_ > 0) {
    improve_mirrored();
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
  assess();
  if (mirror_left_ > 0) return;  // its turn comes
  if (!anchored_ && moved_ <= parameters_.mirrored_keyframes) {
    begin_mirror();
  } else {
    forget_outliers();
  }
}

/// Observations that only the present solution does not explain are kept until the mirrored one had
/// its chance.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::improve_mirrored() {
  T cost = T(0);
  T before = T(0);
  iterate(solutions_[1 - present_], mirror_damping_, before, cost);
  if (--mirror_left_ > 0) return;
  if (cost < parameters_.mirrored_gain * cost_of(now())) {
    present_ = 1 - present_;
    ++mirrored_;
    assess();
  }
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
  // The last block of L D L^T is that of the newest pose, all others eliminated.
  const int count = system_.size();
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

}  // namespace cairn
