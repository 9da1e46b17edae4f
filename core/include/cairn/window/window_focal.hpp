#pragma once

#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/window/focal_belief.hpp"
#include "cairn/window/window_graph.hpp"
#include "cairn/window/window_parameters.hpp"

namespace cairn {

/// The focal length of a KeyframeWindow, as a factor on the one that was told: what is known of it
/// beside the window's observations, its standard deviation, and how poses follow from it. A pose
/// that is fixed is so for a given focal length: it moves with it as it would have when it was
/// estimated.
template <class T, class Bounds>
class WindowFocal {
 public:
  using Graph = WindowGraph<T, Bounds>;
  using Solution = WindowSolution<T, Bounds>;
  using Factors = PackedSymmetric<T, Graph::kMaxStates>;

  /// Starts anew with a standard deviation of the factor; 0: it is known.
  void reset(T sigma) {
    belief_.reset(sigma);
    sigma_ = sigma;
  }
  /// The window begins anew, with WindowParameters::focal_factor.
  void clear(T factor) {
    belief_.leave_all();
    excess_ = square(factor);
    for (Vector<T, 6>& by_focal : by_focal_) by_focal.setZero();
  }
  /// The keyframe at a place leaves the window.
  void leave(int place) { belief_.leave(place); }
  /// A pose is another one now.
  void forget_pose(int pose) { by_focal_[pose].setZero(); }

  /// Whether the window's equations have a state for it.
  bool estimated(const Graph& graph) const {
    return belief_.uncertain() && graph.pose_states() > 0;
  }
  T mean() const { return belief_.mean(); }
  T sigma() const { return sigma_; }
  /// Weight of what is known of it beside the window's observations.
  T weight() const { return excess_ * belief_.information(); }
  T cost(T focal) const { return T(0.5) * weight() * square(focal - belief_.mean()); }
  /// How a pose, a perturbation as in perturbed(), follows from the factor.
  const Vector<T, 6>& by_focal(int pose) const { return by_focal_[pose]; }

  /// Poses that are fixed follow the factor by `change`. `states`: WindowGraph::number_states().
  void move_fixed(const Graph& graph, const int* states, T change, Solution& solution) const;
  /// After an iteration, from the factors L D L^T of the equations: the last element is the focal
  /// length's information, all others eliminated; the last row says how the others follow from it.
  void assess(const Graph& graph, const Factors& factors, T focal,
              const WindowParameters<T>& parameters);

 private:
  FocalBelief<T> belief_;
  Vector<T, 6> by_focal_[Graph::kPoses];
  T sigma_ = T(0);
  T excess_ = T(1);  ///< variance of what the window says of it, over that of its pixels alone
};

template <class T, class Bounds>
void WindowFocal<T, Bounds>::move_fixed(const Graph& graph, const int* states, T change,
                                        Solution& solution) const {
  bool free[Graph::kPoses] = {};
  for (const std::int8_t place : graph.places()) free[graph.pose_of(place)] = states[place] >= 0;
  for (int pose = 0; pose < Graph::kPoses; ++pose) {
    if (free[pose] || !graph.pose_used(pose)) continue;
    const Vector<T, 6> step = change * by_focal_[pose];
    solution.pose[pose] = perturbed(solution.pose[pose], step.data());
  }
}

template <class T, class Bounds>
void WindowFocal<T, Bounds>::assess(const Graph& graph, const Factors& factors, T focal,
                                    const WindowParameters<T>& parameters) {
  const int count = graph.pose_states();
  const T* const last = factors.row(count);
  const T seen = last[count] > weight() ? last[count] - weight() : T(0);
  excess_ = square(parameters.focal_factor) + square(parameters.focal_window_sigma) * seen;
  const T information = belief_.information() + seen / excess_;
  sigma_ = T(1) / sqrt(information);
  unsigned places = 0;
  for (const std::int8_t place : graph.places()) places |= 1U << static_cast<unsigned>(place);
  belief_.note(focal, information, places);
  T follows[Graph::kMaxStates];
  for (int i = count - 1; i >= 0; --i) {
    follows[i] = -last[i];
    for (int k = i + 1; k < count; ++k) follows[i] -= factors.row(k)[i] * follows[k];
  }
  int states[Graph::kKeyframes] = {};
  graph.number_states(states);
  for (const std::int8_t place : graph.places()) {
    if (states[place] < 0) continue;
    for (int r = 0; r < 6; ++r) by_focal_[graph.pose_of(place)](r) = follows[states[place] + r];
  }
}

}  // namespace cairn
