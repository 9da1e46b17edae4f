#pragma once

#include "cairn/base/hash.hpp"
#include "cairn/base/status.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/window/inverse_depth_view.hpp"
#include "cairn/window/window_bounds.hpp"
#include "cairn/window/window_equations.hpp"
#include "cairn/window/window_focal.hpp"
#include "cairn/window/window_graph.hpp"
#include "cairn/window/window_parameters.hpp"
#include "cairn/window/window_pose.hpp"
#include "cairn/window/window_start.hpp"

namespace cairn {

/// Sliding window of keyframes: poses and inverse depths that explain together where landmarks were
/// seen, by Levenberg-Marquardt with the landmarks eliminated (Schur complement) and Huber's cost.
/// A landmark lies on the ray of the keyframe that saw it first, its host; its depth begins with a
/// prior, so that no separate initialisation is needed. The oldest pose is fixed, the oldest two
/// once the window slides; keyframes leave by the distance score of DSO (Engel, Koltun, Cremers
/// 2018). The scale is that of the priors.
///
/// From few views several reliefs and motions explain the picture nearly alike, and the priors lead
/// to one that may be wrong. After each of the first keyframes the motion since an earlier one is
/// therefore sought from the picture alone (WindowStart); where it explains clearly more than the
/// window does, the window begins anew from it, and stays with it where it then explains all
/// keyframes better. What the window refused to explain is kept for this as doubted.
///
/// The focal length is estimated with them, as a factor on the one that the directions are measured
/// with; what windows that left said of it is kept (WindowFocal).
///
/// A gyroscope's turn from one keyframe to the next is one more observation, where it is given.
///
/// Poses are T_camera_world. Directions are (x / z, y / z) without distortion, by the focal length
/// as it is estimated when they are given or asked for. Work is spread:
/// step() is one iteration, wanted while working(). Cost of a step: two passes over the
/// observations in the window (at most kKeyframes * kLandmarks, some 150 and 40 multiply-adds
/// each), (6 (kKeyframes - 1))^2 / 2 multiply-adds a landmark, one solve; or a part of the start's
/// check, of which estimate_epipolar_motion() over 64 landmarks costs most.
template <class T, class Bounds = WindowBounds>
class KeyframeWindow {
 public:
  static constexpr int kKeyframes = Bounds::kKeyframes;
  static constexpr int kLandmarks = Bounds::kLandmarks;
  static constexpr int kPoses = Bounds::kPoses;

  using Parameters = WindowParameters<T>;

  /// Starts anew, empty. kBadConfig, nothing changed.
  Status initialise(const Parameters& parameters);
  /// Forgets keyframes and landmarks.
  void clear();
  /// The same; where nothing is known, new landmarks are expected at this inverse depth.
  void clear(T first_inverse_depth) {
    clear();
    parameters_.first_inverse_depth = first_inverse_depth;
  }
  const Parameters& parameters() const { return parameters_; }

  /// Begins a keyframe at a pose; the window makes room. Its landmarks follow by observe() and
  /// add_landmark(), then finish_keyframe().
  void begin_keyframe(const Rigid<T>& T_camera_world);
  /// After begin_keyframe(): how the camera turned since the keyframe before, by a gyroscope.
  /// R_before_newest, and the variance of each axis, rad^2, on the scale on which the landmarks'
  /// errors are independent. Nothing happens in the first keyframe. Domain: variance > 0.
  void set_turn(const Quaternion<T>& R_before_newest, T variance);
  /// The newest keyframe sees a landmark. Domain: a used slot.
  void observe(int slot, const Vector2<T>& seen);
  /// The same of a direction that the frame's pose does not explain: used for the start alone.
  void doubt(int slot, const Vector2<T>& seen);
  /// Where the newest keyframe saw a landmark, if it did, is known better now.
  void amend(int slot, const Vector2<T>& seen);
  /// A landmark that the newest keyframe sees first, its depth from those that are known (of the
  /// present view), else from the prior. Its slot, -1 when full.
  int add_landmark(LandmarkId id, const Vector2<T>& seen);
  /// A fixed host for landmarks whose place in the world is known; it lasts as long as it has some,
  /// and to the next keyframe. In a window's first keyframe it also settles the start.
  int add_host(const Rigid<T>& T_camera_world);
  /// A landmark of a fixed host, that sees it along `ray` at an inverse depth. Its slot, -1 when
  /// full.
  int add_known_landmark(LandmarkId id, int host, const Vector2<T>& ray, T inverse_depth, T sigma);
  /// Ends a keyframe: forgets landmarks without use, and asks for iterations. `moved`: the camera
  /// did since the one before; from a standing camera or one that turns on the spot, the start
  /// cannot be judged.
  void finish_keyframe(bool moved = true);

  /// Whether iterations are wanted.
  bool working() const { return left_ > 0 || start_.pending(); }
  /// Units of WorkBudget that step() takes.
  int step_work() const;
  /// One iteration, or a part of the start's check. Poses and depths may change, the newest
  /// keyframe's pose too.
  void step();

  /// The landmark is followed no more; it counts while two keyframes saw it.
  void retire(int slot) { graph_.landmark(slot).live = false; }

  int keyframes() const { return graph_.keyframes(); }
  /// Keyframes since the start.
  int started() const { return graph_.started(); }
  /// Whether the start is no longer checked.
  bool settled() const { return anchored_ || moved_ > parameters_.start_keyframes; }
  /// Since clear(), how often the start was corrected.
  int corrected() const { return start_.corrected(); }
  /// The newest keyframe. Domain: there is one.
  const Rigid<T>& newest_pose() const { return solution_.pose[graph_.newest()]; }
  bool newest_sees(int slot, Vector2<T>& seen) const;

  bool used(int slot) const { return graph_.landmark(slot).used; }
  /// Whether it is still to be followed.
  bool live(int slot) const { return graph_.landmark(slot).used && graph_.landmark(slot).live; }
  LandmarkId id(int slot) const { return graph_.landmark(slot).id; }
  T inverse_depth(int slot) const { return solution_.rho[slot]; }  ///< in its host
  T sigma(int slot) const { return graph_.landmark(slot).sigma; }  ///< of inverse_depth()
  /// What estimate_window_pose() asks of a landmark, but for where it is seen.
  WindowSighting<T> sighting(int slot) const;
  /// Where a camera sees the landmark. False where it is behind it.
  bool project(int slot, const Rigid<T>& T_camera_world, Vector2<T>& seen) const;
  Vector3<T> position(int slot) const;  ///< world
  /// Inverse depth in a camera; 0 where the landmark is behind it.
  T inverse_depth_in(int slot, const Rigid<T>& T_camera_world) const {
    return graph_.inverse_depth_in(solution_, slot, T_camera_world);
  }
  /// Of a landmark that the newest keyframe sees first.
  T expected_inverse_depth();
  /// Median inverse depth, in a view, of the landmarks known to a third of their depth; 0 with
  /// fewer than eight.
  T typical_inverse_depth(const Rigid<T>& T_camera_world) const;
  /// Covariance of the newest keyframe's pose, of a perturbation as in perturbed(), relative to the
  /// fixed keyframes, as if the directions' errors were independent. Zero before the first steps.
  const Matrix<T, 6, 6>& newest_covariance() const { return newest_covariance_; }
  /// Of the keyframe that the others' poses are relative to: the newest of those that are fixed.
  int reference() const {
    const int fixed = graph_.fixed();
    return graph_.pose_at((graph_.keyframes() > fixed ? fixed : graph_.keyframes()) - 1);
  }
  int newest() const { return graph_.newest(); }

  /// Focal length, as a factor on the one that was told, and its standard deviation.
  T focal_scale() const { return solution_.focal; }
  T focal_sigma() const { return focal_.sigma(); }
  /// How the newest keyframe's pose, a perturbation, follows from the focal scale.
  const Vector<T, 6>& newest_by_focal() const { return focal_.by_focal(newest()); }

  void hash(Hash64& hash) const;

 private:
  using Graph = WindowGraph<T, Bounds>;
  using Landmark = WindowLandmark<T>;
  using Solution = WindowSolution<T, Bounds>;

  static constexpr T kFirstDamping = T(1e-4);
  // Units of step_work().
  static constexpr int kStepBase = 60;
  static constexpr int kStepPair = 4;  ///< of a host and a keyframe that sees some of it
  static constexpr int kStepTenObservations = 11;   ///< of a landmark by a keyframe
  static constexpr int kStatesSquaredInUnit = 400;  ///< that eliminate a landmark from as many
  static constexpr int kStatesCubedInUnit = 500;    ///< of the solution

  WindowProblem<T, Bounds> problem() const {
    return {graph_, focal_, parameters_.sigma, parameters_.huber_sigma};
  }
  void improve();
  bool iterate(T& before, T& cost);
  void assess();
  void forget_outliers();

  Parameters parameters_;
  Graph graph_;
  WindowFocal<T, Bounds> focal_;
  WindowEquations<T, Bounds> equations_;
  WindowStart<T, Bounds> start_;
  Solution solution_ = {};
  Solution trial_ = {};
  Matrix<T, 6, 6> newest_covariance_ = Matrix<T, 6, 6>::Zero();
  int moved_ = 0;       ///< keyframes whose camera moved, since the start
  int left_ = 0;        ///< iterations
  T new_depth_ = T(0);  ///< inverse, of the newest keyframe's own landmarks; 0: not yet known
  T damping_ = kFirstDamping;
  bool anchored_ = false;
};

}  // namespace cairn

#include "cairn/window/detail/keyframe_window_impl.hpp"
#include "cairn/window/detail/window_iteration.hpp"
