#pragma once

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/window/detail/window_cost.hpp"
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

/// The focal length's part of the normal equations, from what one keyframe saw of one host.
template <class T>
struct FocalColumn {
  Vector<T, 6> by_pose = Vector<T, 6>::Zero();
  T information = T(0);
  T gradient = T(0);

  /// `carried`: how the step between the two follows where their poses are fixed.
  FocalColumn(const CameraStep<T>& step, T narrower, const Vector<T, 6>& carried)
      : narrower_(narrower),
        turn_(carried.template head<3>()),
        axis_(narrower * step.rotation.col(2)),
        shift_(narrower * step.translation + carried.template tail<3>()) {}

  /// Adds an observation; returns the element that couples the focal length to the depth. A longer
  /// focal length makes the host's ray narrower and the picture of a direction larger.
  T add(const InverseDepthView<T>& view, const InverseDepthJacobian<T>& j, T rho, T weight,
        const Vector2<T>& residual) {
    const Vector3<T> moved = axis_ + turn_.cross(view.p) + rho * shift_;
    const T inverse = T(1) / view.p.z();
    T by_focal[2];
    for (int i = 0; i < 2; ++i) {
      by_focal[i] = narrower_ * view.seen(i) + inverse * (moved(i) - view.seen(i) * moved.z());
    }
    const T u = weight * by_focal[0];
    const T v = weight * by_focal[1];
    for (int r = 0; r < 6; ++r) by_pose(r) += u * j.by_pose[0][r] + v * j.by_pose[1][r];
    information += u * by_focal[0] + v * by_focal[1];
    gradient += u * residual.x() + v * residual.y();
    return u * j.by_depth[0] + v * j.by_depth[1];
  }

 private:
  T narrower_;
  Vector3<T> turn_;
  Vector3<T> axis_;
  Vector3<T> shift_;
};

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

template <class T, class Bounds>
typename KeyframeWindow<T, Bounds>::Hosted KeyframeWindow<T, Bounds>::hosted_by(int host) const {
  Hosted hosted;
  for (int slot = 0; slot < kLandmarks; ++slot) {
    const Landmark& landmark = landmarks_[slot];
    if (landmark.host != host) continue;
    hosted.slots[hosted.count++] = static_cast<std::int16_t>(slot);
    hosted.seen = static_cast<std::uint8_t>(hosted.seen | landmark.seen);
  }
  return hosted;
}

/// Adds what the keyframe at `place` saw of the landmarks of one host.
template <class T, class Bounds>
void KeyframeWindow<T, Bounds>::add_pair(const Solution& solution, int host, const Hosted& hosted,
                                         int place, const int* states, T& cost) {
  const CameraStep<T> step(solution.pose[host], solution.pose[slot_of_[place]]);
  const Matrix<T, 6, 6> ad = detail::adjoint(step);
  const int host_place = place_of(host);
  const int target_state = states[place];
  const int host_state = host_place >= 0 ? states[host_place] : -1;
  const T narrower = T(1) / solution.focal;
  const T per_sigma = solution.focal / parameters_.sigma;
  Matrix<T, 6, 6> information = Matrix<T, 6, 6>::Zero();  // lower triangle
  Vector<T, 6> gradient = Vector<T, 6>::Zero();
  const bool with_focal = estimates_focal();
  const int focal_state = pose_states();
  Vector<T, 6> carried = Vector<T, 6>::Zero();
  if (with_focal && target_state < 0) carried = by_focal_[slot_of_[place]];
  if (with_focal && host_state < 0) carried -= ad * by_focal_[host];
  detail::FocalColumn<T> focal(step, narrower, carried);
  for (int i = 0; i < hosted.count; ++i) {
    const int slot = hosted.slots[i];
    const Landmark& landmark = landmarks_[slot];
    if (((landmark.seen >> place) & 1) == 0) continue;
    InverseDepthView<T> view;
    const T rho = solution.rho[slot];
    if (!view.project(step, narrower * landmark.ray, rho)) {
      cost += detail::kHiddenCost<T>;
      continue;
    }
    const Vector2<T> residual = narrower * observed_[place][slot] - view.seen;
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
    if (with_focal) reduced.by_pose[focal_state] += focal.add(view, j, rho, weight, residual);
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
  if (with_focal) {
    T* const row = system_.row(focal_state);
    row[focal_state] += focal.information;
    gradient_[focal_state] += focal.gradient;
    for (int r = 0; r < 6 && target_state >= 0; ++r) row[target_state + r] += focal.by_pose(r);
    const Vector<T, 6> turned = ad.transpose() * focal.by_pose;
    for (int r = 0; r < 6 && host_state >= 0; ++r) row[host_state + r] -= turned(r);
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
  const bool with_focal = estimates_focal();
  const int count = pose_states() + (with_focal ? 1 : 0);
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
  if (with_focal) {
    cost = focal_cost(solution);
    system_(count - 1, count - 1) = focal_weight();
    gradient_[count - 1] = focal_weight() * (belief_.mean() - solution.focal);
  }
  for (int host = 0; host < kPoses; ++host) {
    if (!hosts[host]) continue;
    const Hosted hosted = hosted_by(host);
    for (const std::int8_t place : order_) {
      if (slot_of_[place] != host && ((hosted.seen >> place) & 1) != 0) {
        add_pair(solution, host, hosted, place, states, cost);
      }
    }
  }
  for (int i = fixed(); i < order_.size(); ++i) {
    if (turns_[order_[i]].known) add_turn(solution, i, states, cost);
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
  const T narrower = T(1) / solution.focal;
  const T per_sigma = solution.focal / parameters_.sigma;
  T cost = estimates_focal() ? focal_cost(solution) : T(0);
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
        if (!view.project(steps[place], narrower * landmark.ray, solution.rho[slot])) {
          cost += detail::kHiddenCost<T>;
          continue;
        }
        const Vector2<T> residual = narrower * observed_[place][slot] - view.seen;
        cost +=
            detail::window_cost(sqrt(residual.squaredNorm()) * per_sigma, parameters_.huber_sigma);
      }
    }
  }
  for (int i = fixed(); i < order_.size(); ++i) {
    if (!turns_[order_[i]].known) continue;
    T distance = T(0);
    static_cast<void>(turn_left(solution, i, distance));
    cost += detail::window_cost(distance, parameters_.huber_sigma);
  }
  return cost;
}

}  // namespace cairn
