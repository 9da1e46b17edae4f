#pragma once

#include "cairn/window/window_equations.hpp"

namespace cairn {

/// Adds what the keyframe at `place` saw of the landmarks of one host.
template <class T, class Bounds>
void WindowEquations<T, Bounds>::add_pair(const Problem& problem, const Solution& solution,
                                          int host, const Hosted& hosted, int place,
                                          const int* states, T& cost) {
  const Graph& graph = problem.graph;
  const CameraStep<T> step(solution.pose[host], solution.pose[graph.pose_of(place)]);
  const Matrix<T, 6, 6> ad = detail::adjoint(step);
  const int host_place = graph.place_of(host);
  const int target_state = states[place];
  const int host_state = host_place >= 0 ? states[host_place] : -1;
  const T narrower = T(1) / solution.focal;
  const T per_sigma = solution.focal / problem.sigma;
  Matrix<T, 6, 6> information = Matrix<T, 6, 6>::Zero();  // lower triangle
  Vector<T, 6> gradient = Vector<T, 6>::Zero();
  const bool with_focal = problem.focal.estimated(graph);
  const int focal_state = graph.pose_states();
  Vector<T, 6> carried = Vector<T, 6>::Zero();
  if (with_focal && target_state < 0) carried = problem.focal.by_focal(graph.pose_of(place));
  if (with_focal && host_state < 0) carried -= ad * problem.focal.by_focal(host);
  detail::FocalColumn<T> focal(step, narrower, carried);
  for (int i = 0; i < hosted.count; ++i) {
    const int slot = hosted.slots[i];
    const WindowLandmark<T>& landmark = graph.landmark(slot);
    if (!landmark.seen_at(place)) continue;
    InverseDepthView<T> view;
    const T rho = solution.rho[slot];
    if (!view.project(step, narrower * landmark.ray, rho)) {
      cost += detail::kHiddenCost<T>;
      continue;
    }
    const Vector2<T> residual = narrower * graph.observed(place, slot) - view.seen;
    const T distance = sqrt(residual.squaredNorm()) * per_sigma;
    cost += detail::window_cost(distance, problem.huber_sigma);
    const T robust = distance < problem.huber_sigma ? T(1) : problem.huber_sigma / distance;
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
    Reduced& reduced = landmarks_[slot];
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

template <class T, class Bounds>
T WindowEquations<T, Bounds>::build(const Problem& problem, const Solution& solution) {
  const Graph& graph = problem.graph;
  const bool with_focal = problem.focal.estimated(graph);
  const int count = graph.pose_states() + (with_focal ? 1 : 0);
  int states[Graph::kKeyframes] = {};
  graph.number_states(states);
  system_.resize(count);
  system_.set_zero();
  for (T& g : gradient_) g = T(0);
  bool hosts[Graph::kPoses] = {};
  for (int slot = 0; slot < Graph::kLandmarks; ++slot) {
    landmarks_[slot].clear(count);
    const WindowLandmark<T>& landmark = graph.landmark(slot);
    if (landmark.used) hosts[landmark.host] = true;
  }
  T cost = T(0);
  if (with_focal) {
    cost = problem.focal.cost(solution.focal);
    system_(count - 1, count - 1) = problem.focal.weight();
    gradient_[count - 1] = problem.focal.weight() * (problem.focal.mean() - solution.focal);
  }
  for (int host = 0; host < Graph::kPoses; ++host) {
    if (!hosts[host]) continue;
    const Hosted hosted = graph.hosted_by(host);
    for (const std::int8_t place : graph.places()) {
      if (graph.pose_of(place) != host && ((hosted.seen >> place) & 1) != 0) {
        add_pair(problem, solution, host, hosted, place, states, cost);
      }
    }
  }
  for (int i = graph.fixed(); i < graph.keyframes(); ++i) {
    if (graph.turn_at(i).known) add_turn(problem, solution, i, states, cost);
  }
  for (int slot = 0; slot < Graph::kLandmarks; ++slot) {
    Reduced& reduced = landmarks_[slot];
    if (!reduced.used) continue;
    const WindowLandmark<T>& landmark = graph.landmark(slot);
    const T information = T(1) / square(landmark.prior_sigma);
    cost += prior_cost(landmark, solution.rho[slot]);
    reduced.information += information;
    reduced.gradient += information * (landmark.prior - solution.rho[slot]);
  }
  return cost;
}

template <class T, class Bounds>
T WindowEquations<T, Bounds>::cost_of(const Problem& problem, const Solution& solution,
                                      T most) const {
  const auto bounded = [most](T own) { return own < most ? own : most; };
  const Graph& graph = problem.graph;
  const T narrower = T(1) / solution.focal;
  const T per_sigma = solution.focal / problem.sigma;
  T cost = problem.focal.estimated(graph) ? problem.focal.cost(solution.focal) : T(0);
  CameraStep<T> steps[Graph::kKeyframes];
  for (int host = 0; host < Graph::kPoses; ++host) {
    bool known = false;
    for (int slot = 0; slot < Graph::kLandmarks; ++slot) {
      const WindowLandmark<T>& landmark = graph.landmark(slot);
      if (landmark.host != host) continue;
      if (!known) {
        for (const std::int8_t place : graph.places()) {
          steps[place] = CameraStep<T>(solution.pose[host], solution.pose[graph.pose_of(place)]);
        }
        known = true;
      }
      if (landmarks_[slot].used) cost += prior_cost(landmark, solution.rho[slot]);
      for (const std::int8_t place : graph.places()) {
        if (graph.pose_of(place) == host || !landmark.seen_at(place)) continue;
        InverseDepthView<T> view;
        if (!view.project(steps[place], narrower * landmark.ray, solution.rho[slot])) {
          cost += bounded(detail::kHiddenCost<T>);
          continue;
        }
        const Vector2<T> residual = narrower * graph.observed(place, slot) - view.seen;
        cost += bounded(
            detail::window_cost(sqrt(residual.squaredNorm()) * per_sigma, problem.huber_sigma));
      }
    }
  }
  for (int i = graph.fixed(); i < graph.keyframes(); ++i) {
    if (!graph.turn_at(i).known) continue;
    T distance = T(0);
    static_cast<void>(turn_left(graph, solution, i, distance));
    cost += detail::window_cost(distance, problem.huber_sigma);
  }
  return cost;
}

/// What a solution leaves of a keyframe's turn, in its axes; `distance`: in sigmas.
template <class T, class Bounds>
Vector3<T> WindowEquations<T, Bounds>::turn_left(const Graph& graph, const Solution& solution,
                                                 int index, T& distance) {
  const typename Graph::Turn& turn = graph.turn_at(index);
  const Quaternion<T>& before = solution.pose[graph.pose_at(index - 1)].rotation;
  const Quaternion<T>& present = solution.pose[graph.pose_at(index)].rotation;
  const Vector3<T> left = rotation_log(turn.rotation * before * present.conjugate());
  distance = sqrt(left.squaredNorm() / turn.variance);
  return left;
}

/// R_measured = Exp(left) R_present R_before^T: a small turn of the present pose takes from what is
/// left, one of the pose before adds it, turned into the present axes. Poses that are fixed do so
/// as they follow the focal length.
template <class T, class Bounds>
void WindowEquations<T, Bounds>::add_turn(const Problem& problem, const Solution& solution,
                                          int index, const int* states, T& cost) {
  const Graph& graph = problem.graph;
  const int place = graph.places()[index];
  const int place_before = graph.places()[index - 1];
  const int state = states[place];
  const int state_before = states[place_before];
  T distance = T(0);
  const Vector3<T> left = turn_left(graph, solution, index, distance);
  cost += detail::window_cost(distance, problem.huber_sigma);
  const T robust = distance < problem.huber_sigma ? T(1) : problem.huber_sigma / distance;
  const T weight = robust / graph.turn_at(index).variance;
  const Matrix3<T> across = (solution.pose[graph.pose_of(place)].rotation *
                             solution.pose[graph.pose_of(place_before)].rotation.conjugate())
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
  if (!problem.focal.estimated(graph) || state_before >= 0) return;
  const int focal_state = graph.pose_states();
  const Vector3<T> follows =
      -(across * problem.focal.by_focal(graph.pose_of(place_before)).template head<3>());
  system_(focal_state, focal_state) += weight * follows.squaredNorm();
  gradient_[focal_state] += weight * follows.dot(left);
  for (int r = 0; r < 3; ++r) system_(focal_state, state + r) += weight * follows(r);
}

template <class T, class Bounds>
bool WindowEquations<T, Bounds>::newest_covariance(const Graph& graph,
                                                   Matrix<T, 6, 6>& covariance) const {
  const int count = graph.pose_states();
  if (count < 6 || !solved_) return false;
  // The last block of L D L^T is that of the newest pose, all others eliminated.
  Matrix<T, 6, 6> information;
  for (int r = 0; r < 6; ++r) {
    for (int c = 0; c <= r; ++c) {
      T sum = T(0);
      for (int k = 0; k <= c; ++k) {
        const T* const d = factors_.row(count - 6 + k) + count - 6;
        const T left = k == r ? T(1) : factors_.row(count - 6 + r)[count - 6 + k];
        const T right = k == c ? T(1) : factors_.row(count - 6 + c)[count - 6 + k];
        sum += left * right * d[k];
      }
      information(r, c) = sum;
    }
  }
  return detail::invert_spd(information, T(1e-7), covariance);
}

}  // namespace cairn
