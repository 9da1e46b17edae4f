#pragma once

#include <cstdint>

#include "cairn/base/fixed_vector.hpp"
#include "cairn/window/epipolar_motion.hpp"
#include "cairn/window/window_graph.hpp"
#include "cairn/window/window_parameters.hpp"
#include "cairn/window/window_pose.hpp"

namespace cairn {

/// Checks the start of a KeyframeWindow, in three steps after a keyframe: judge() whether another
/// motion since an earlier keyframe could explain the picture clearly better than the window's,
/// seek it from the picture alone (estimate_epipolar_motion()), and let the window begin anew from
/// it, at its scale. Keeps the solution from before until the two are compared.
template <class T, class Bounds>
class WindowStart {
 public:
  using Graph = WindowGraph<T, Bounds>;
  using Solution = WindowSolution<T, Bounds>;
  using Parameters = WindowParameters<T>;

  void clear() {
    stage_ = Stage::kNone;
    compared_ = true;
    corrected_ = 0;
  }
  /// Begins a check, and gives one up.
  void begin() { stage_ = Stage::kJudge; }
  void stop() { stage_ = Stage::kNone; }
  bool pending() const { return stage_ != Stage::kNone; }
  /// Units of WorkBudget that step() takes.
  int step_work(const Graph& graph) const;
  /// The next step of a check, if one is pending().
  void step(Graph& graph, Solution& solution, const Parameters& parameters);

  /// Since clear(), how often the start was corrected.
  int corrected() const { return corrected_; }
  /// Whether no correction waits for settle().
  bool compared() const { return compared_; }
  const Solution& before() const { return before_; }
  /// Compares a corrected solution with the one before, by their costs. True where that was better,
  /// and `solution` is it again: a plane, for one, shows two motions in two pictures.
  bool settle(T cost, T cost_before, Solution& solution) {
    compared_ = true;
    if (cost < cost_before) return false;
    solution = before_;
    ++corrected_;
    return true;
  }

  // The solution before grows with the window's.
  /// A keyframe whose motion is known relative to one that the window has.
  void add_keyframe(int pose, int last, const Rigid<T>& T_pose_last) {
    before_.pose[pose] = T_pose_last * before_.pose[last];
  }
  void add_host(int pose, const Rigid<T>& T_camera_world) { before_.pose[pose] = T_camera_world; }
  void add_landmark(int slot, T rho) { before_.rho[slot] = rho; }

 private:
  enum class Stage : std::uint8_t { kNone, kJudge, kSeek, kTake };
  // Units of step_work().
  static constexpr int kJudgeWork = 110;
  static constexpr int kSeekWork = 1400;
  static constexpr int kTakeWork = 60;
  static constexpr int kPoseWork = 270;  ///< of a keyframe between

  static constexpr int kPairs = Graph::kLandmarks < 64 ? Graph::kLandmarks : 64;  ///< at most
  static constexpr int kLeastPairs = 24;
  static constexpr T kRange = T(20);  ///< of depths to the typical one, either way

  /// What two keyframes both see.
  struct View {
    FixedVector<DirectionPair<T>, kPairs> pairs;
    std::int16_t slots[kPairs] = {};
  };

  void judge(const Graph& graph, const Solution& solution, const Parameters& parameters,
             View& view);
  void seek(const Solution& solution, const Parameters& parameters, const View& view);
  void take(Graph& graph, Solution& solution, const Parameters& parameters, const View& view);
  void common_view(const Graph& graph, const Solution& solution, int place, View& view) const;
  // Not inline: take_poses() needs the most stack, and their locals would lie below it.
  __attribute__((noinline)) T depths(const Graph& graph, const Solution& solution, const View& view,
                                     T* rho);
  __attribute__((noinline)) void take_hosts(const Graph& graph, const View& view, const T* rho,
                                            T typical, Solution& solution) const;
  void take_poses(const Graph& graph, const View& view, const T* rho, T sigma,
                  Solution& solution) const;
  static EpipolarOptions<T> options(const Solution& solution, const Parameters& parameters) {
    EpipolarOptions<T> options;
    options.sigma = parameters.sigma / solution.focal;
    options.huber_sigma = parameters.huber_sigma;
    return options;
  }

  Solution before_ = {};
  bool compared_ = true;
  int corrected_ = 0;
  Stage stage_ = Stage::kNone;
  int from_ = 0;     ///< index of the keyframe that the motion is relative to
  T cost_ = T(0);    ///< of the window's motion from it to the newest
  Rigid<T> motion_;  ///< another one, translation of length 1
};

}  // namespace cairn

#include "cairn/window/detail/window_start_impl.hpp"
