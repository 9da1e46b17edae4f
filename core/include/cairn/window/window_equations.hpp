#pragma once

#include "cairn/geometry/detail/spd_inverse.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/window/detail/focal_column.hpp"
#include "cairn/window/detail/window_cost.hpp"
#include "cairn/window/schur_solve.hpp"
#include "cairn/window/window_focal.hpp"
#include "cairn/window/window_graph.hpp"

namespace cairn {

/// What a solution of a KeyframeWindow is judged by.
template <class T, class Bounds>
struct WindowProblem {
  const WindowGraph<T, Bounds>& graph;
  const WindowFocal<T, Bounds>& focal;
  T sigma;  ///< of a direction, each axis
  T huber_sigma;
};

/// Normal equations of a KeyframeWindow: each observation of a landmark by a keyframe that is not
/// its host, each turn by a gyroscope, each landmark's prior, and what is known of the focal
/// length. States: WindowGraph::number_states(), then the focal length where it is estimated; the
/// landmarks' inverse depths are eliminated. Cost of build(), and of cost_of(): a pass over the
/// observations, some 150 and 40 multiply-adds each; of solve(): states^2 / 2 a landmark.
template <class T, class Bounds>
class WindowEquations {
 public:
  using Graph = WindowGraph<T, Bounds>;
  using Solution = WindowSolution<T, Bounds>;
  using Problem = WindowProblem<T, Bounds>;
  static constexpr int kMaxStates = Graph::kMaxStates;
  using System = PackedSymmetric<T, kMaxStates>;
  using Reduced = LandmarkEquation<T, kMaxStates>;

  /// Equations at a solution; returns its cost.
  T build(const Problem& problem, const Solution& solution);
  /// Cost over the landmarks that the last build() used; an observation counts for `most` at most.
  T cost_of(const Problem& problem, const Solution& solution, T most = T(1e30)) const;
  /// Step of the states, of Levenberg and Marquardt. False where the equations are singular.
  bool solve(T damping, T* step) {
    solved_ = solve_with_landmarks(system_, gradient_, landmarks_, Graph::kLandmarks, damping,
                                   factors_, step);
    return solved_;
  }
  /// None holds any more.
  void forget() { solved_ = false; }

  int states() const { return system_.size(); }
  const Reduced& landmark(int slot) const { return landmarks_[slot]; }
  bool solved() const { return solved_; }
  /// L D L^T of the states' equations. Domain: solved().
  const System& factors() const { return factors_; }
  /// Covariance of the newest pose, relative to the fixed ones. False, nothing changed, where they
  /// do not tell.
  bool newest_covariance(const Graph& graph, Matrix<T, 6, 6>& covariance) const;

 private:
  using Hosted = typename Graph::Hosted;

  void add_pair(const Problem& problem, const Solution& solution, int host, const Hosted& hosted,
                int place, const int* states, T& cost);
  void add_turn(const Problem& problem, const Solution& solution, int index, const int* states,
                T& cost);
  static Vector3<T> turn_left(const Graph& graph, const Solution& solution, int index, T& distance);
  static T prior_cost(const WindowLandmark<T>& landmark, T rho) {
    return T(0.5) * square((landmark.prior - rho) / landmark.prior_sigma);
  }

  System system_;
  T gradient_[kMaxStates] = {};
  Reduced landmarks_[Graph::kLandmarks];
  System factors_;
  bool solved_ = false;
};

}  // namespace cairn

#include "cairn/window/detail/window_equations_impl.hpp"
