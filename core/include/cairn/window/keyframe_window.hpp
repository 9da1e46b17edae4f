#pragma once

#include <cstdint>

#include "cairn/base/fixed_vector.hpp"
#include "cairn/base/hash.hpp"
#include "cairn/base/status.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"
#include "cairn/window/epipolar_motion.hpp"
#include "cairn/window/focal_belief.hpp"
#include "cairn/window/inverse_depth_view.hpp"
#include "cairn/window/schur_solve.hpp"
#include "cairn/window/window_bounds.hpp"
#include "cairn/window/window_pose.hpp"

namespace cairn {

template <class T>
struct WindowParameters {
  T sigma = T(0.0015);  ///< of a measured direction, each axis: pixels / focal length
  T huber_sigma = T(1.5);
  T outlier_sigma = T(4);          ///< observations farther off are forgotten
  T first_inverse_depth = T(1);    ///< of landmarks while no depth is known
  T depth_prior_sigma = T(0.5);    ///< of a new landmark, relative to its inverse depth
  T sigma_factor = T(1.5);         ///< of an inverse depth, over what its own observations give
  int iterations = 6;              ///< after a keyframe
  int start_keyframes = 8;         ///< with parallax, up to which the start is checked,
  T start_gain = T(0.7);           ///< and corrected where another motion costs less than this
  T start_margin = T(3);           ///< share of the window's, less this
  T focal_sigma = T(0.1);          ///< of the focal length, relative; 0: it is not estimated
  T focal_factor = T(8);           ///< of its sigma, over what a window's pixels alone give
  T focal_window_sigma = T(0.03);  ///< relative, of what one window says of it, at least

  /// kBadConfig unless every value is finite and in its domain.
  Status validate() const {
    const bool good = is_positive(sigma) && is_positive(huber_sigma) &&
                      is_positive(outlier_sigma) && is_positive(first_inverse_depth) &&
                      is_positive(depth_prior_sigma) && is_positive(sigma_factor) &&
                      iterations >= 1 && iterations <= 100 && start_keyframes >= 0 &&
                      start_gain >= T(0) && start_gain <= T(1) && is_finite(start_margin) &&
                      start_margin >= T(0) && is_finite(focal_sigma) && focal_sigma >= T(0) &&
                      focal_sigma <= T(1) && is_positive(focal_factor) &&
                      is_finite(focal_window_sigma) && focal_window_sigma >= T(0);
    return good ? Status::kOk : Status::kBadConfig;
  }
};

/// Sliding window of keyframes: poses and inverse depths that explain together where landmarks were
/// seen, by Levenberg-Marquardt with the landmarks eliminated (Schur complement) and Huber's cost.
/// A landmark lies on the ray of the keyframe that saw it first, its host; its depth begins with a
/// prior, so that no separate initialisation is needed. The oldest pose is fixed, the oldest two
/// once the window slides; keyframes leave by the distance score of DSO (Engel, Koltun, Cremers
/// 2018). The scale is that of the priors.
///
/// From few views several reliefs and motions explain the picture nearly alike, and the priors lead
/// to one that may be wrong. After each of the first keyframes the motion since an earlier one is
/// therefore sought from the picture alone (estimate_epipolar_motion()); where it explains clearly
/// more than the window does, the window begins anew from it, and stays with it where it then
/// explains all keyframes better. What the window refused to explain is kept for this as doubted.
///
/// The focal length is estimated with them, as a factor on the one that the directions are measured
/// with; what windows that left said of it is kept (FocalBelief). A pose that is fixed is so for a
/// given focal length: it moves with it as it would have when it was estimated.
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
  static constexpr int kMaxStates = 6 * (kKeyframes - 1) + 1;  ///< the last: the focal length
  static_assert(kKeyframes >= 3 && kKeyframes <= 8, "observations are flagged in a byte");
  static_assert(kPoses > kKeyframes && kPoses <= 127 && kLandmarks <= 1024, "bounds");

  using Parameters = WindowParameters<T>;
  using System = PackedSymmetric<T, kMaxStates>;

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
  bool working() const { return left_ > 0 || start_ != Start::kNoCheck; }
  /// Units of WorkBudget that step() takes.
  int step_work() const;
  /// One iteration, or a part of the start's check. Poses and depths may change, the newest
  /// keyframe's pose too.
  void step();

  /// The landmark is followed no more; it counts while two keyframes saw it.
  void retire(int slot) { landmarks_[slot].live = false; }

  int keyframes() const { return order_.size(); }
  /// Keyframes since the start.
  int started() const { return started_; }
  /// Whether the start is no longer checked.
  bool settled() const { return anchored_ || moved_ > parameters_.start_keyframes; }
  /// Since clear(), how often the start was corrected.
  int corrected() const { return corrected_; }
  /// The newest keyframe. Domain: there is one.
  const Rigid<T>& newest_pose() const { return now().pose[slot_of_[order_.back()]]; }
  bool newest_sees(int slot, Vector2<T>& seen) const;

  bool used(int slot) const { return landmarks_[slot].used; }
  /// Whether it is still to be followed.
  bool live(int slot) const { return landmarks_[slot].used && landmarks_[slot].live; }
  LandmarkId id(int slot) const { return landmarks_[slot].id; }
  T inverse_depth(int slot) const { return now().rho[slot]; }  ///< in its host
  T sigma(int slot) const { return landmarks_[slot].sigma; }   ///< of inverse_depth()
  /// What estimate_window_pose() asks of a landmark, but for where it is seen.
  WindowSighting<T> sighting(int slot) const;
  /// Where a camera sees the landmark. False where it is behind it.
  bool project(int slot, const Rigid<T>& T_camera_world, Vector2<T>& seen) const;
  Vector3<T> position(int slot) const;  ///< world
  /// Inverse depth in a camera; 0 where the landmark is behind it.
  T inverse_depth_in(int slot, const Rigid<T>& T_camera_world) const;
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
    return slot_of_[order_[(order_.size() > fixed() ? fixed() : order_.size()) - 1]];
  }
  int newest() const { return slot_of_[order_.back()]; }

  /// Focal length, as a factor on the one that was told, and its standard deviation.
  T focal_scale() const { return now().focal; }
  T focal_sigma() const { return focal_sigma_; }
  /// How the newest keyframe's pose, a perturbation, follows from the focal scale.
  const Vector<T, 6>& newest_by_focal() const { return by_focal_[newest()]; }

  void hash(Hash64& hash) const;

 private:
  static constexpr T kFirstDamping = T(1e-4);
  // Units of step_work().
  static constexpr int kStepBase = 60;
  static constexpr int kStepPair = 4;  ///< of a host and a keyframe that sees some of it
  static constexpr int kStepTenObservations = 11;   ///< of a landmark by a keyframe
  static constexpr int kStatesSquaredInUnit = 400;  ///< that eliminate a landmark from as many
  static constexpr int kStatesCubedInUnit = 500;    ///< of the solution
  static constexpr int kJudgeStart = 110;
  static constexpr int kSeekStart = 1400;
  static constexpr int kTakeStart = 60;
  static constexpr int kStartPose = 270;  ///< of a keyframe between

  static constexpr int kStartPairs = kLandmarks < 64 ? kLandmarks : 64;  ///< at most
  static constexpr int kLeastStartPairs = 24;
  static constexpr T kStartRange = T(20);  ///< of depths to the typical one, either way

  struct Landmark {
    LandmarkId id = kNoLandmark;
    Vector2<T> ray = Vector2<T>::Zero();
    T prior = T(0);
    T prior_sigma = T(0);
    T sigma = T(0);
    std::int8_t host = -1;     ///< slot of a pose
    std::uint8_t seen = 0;     ///< a bit per place in the window
    std::uint8_t doubted = 0;  ///< same; known to the start's check alone
    bool used = false;
    bool live = false;
  };
  enum class Start : std::uint8_t { kNoCheck, kJudge, kSeek, kTake };
  /// What two keyframes both see.
  struct StartView {
    FixedVector<DirectionPair<T>, kStartPairs> pairs;
    int slots[kStartPairs] = {};
  };
  /// All that an iteration changes.
  struct Solution {
    Rigid<T> pose[kPoses];
    T rho[kLandmarks];
    T focal = T(1);
  };
  using Reduced = LandmarkEquation<T, kMaxStates>;
  /// The landmarks of a host, and the places in the window that see some of them.
  struct Hosted {
    std::int16_t slots[kLandmarks];
    int count = 0;
    std::uint8_t seen = 0;
  };
  /// How a keyframe is turned from the one before it in the window, by a gyroscope.
  struct Turn {
    bool known = false;
    Quaternion<T> rotation = Quaternion<T>(T(1), T(0), T(0), T(0));  ///< R_present_before
    T variance = T(1);
  };

  const Solution& now() const { return solution_; }
  Solution& now() { return solution_; }
  int place_of(int pose) const;
  int free_place();
  int free_pose();
  void drop(int index);
  void join_turns(int index);
  int worst_keyframe(const Rigid<T>& newest) const;
  int fixed() const { return started_ > kKeyframes ? 2 : 1; }
  int pose_states() const { return order_.size() > fixed() ? 6 * (order_.size() - fixed()) : 0; }
  bool estimates_focal() const { return belief_.uncertain() && pose_states() > 0; }
  /// Weight of what is known of the focal length beside the window's observations.
  T focal_weight() const { return focal_excess_ * belief_.information(); }
  /// As told, and as the focal length is estimated.
  Vector2<T> as_told(const Vector2<T>& direction) const { return now().focal * direction; }
  Vector2<T> as_estimated(const Vector2<T>& told) const { return T(1) / now().focal * told; }
  T focal_cost(const Solution& solution) const {
    return T(0.5) * focal_weight() * square(solution.focal - belief_.mean());
  }
  void number_states(int* states) const;
  void move_fixed(const int* states, T focal_step, Solution& solution) const;
  int observers(const Landmark& landmark) const;
  void forget_unused();
  T build(const Solution& solution, const int* states);
  Hosted hosted_by(int host) const;
  void add_pair(const Solution& solution, int host, const Hosted& hosted, int place,
                const int* states, T& cost);
  T cost_of(const Solution& solution) const;
  Vector3<T> turn_left(const Solution& solution, int index, T& distance) const;
  void add_turn(const Solution& solution, int index, const int* states, T& cost);
  bool iterate(Solution& solution, T& damping, T& before, T& cost);
  void improve();
  EpipolarOptions<T> start_options() const;
  void common_view(int place, StartView& view) const;
  void judge_start();
  void seek_start();
  void take_start();
  void compare_start();
  T start_depths(const StartView& view, T* rho);
  void start_poses(const StartView& view, const T* rho);
  void start_hosts(const StartView& view, const T* rho, T typical);
  void assess();
  void assess_focal();
  void forget_outliers();
  T prior_cost(const Solution& solution, int slot) const;

  Parameters parameters_;
  Landmark landmarks_[kLandmarks] = {};
  Vector2<T> observed_[kKeyframes][kLandmarks];
  FixedVector<std::int8_t, kKeyframes> order_;  ///< places, oldest first
  std::int8_t slot_of_[kKeyframes] = {};        ///< place to pose
  Turn turns_[kKeyframes] = {};                 ///< of each place
  bool pose_used_[kPoses] = {};
  Solution solution_ = {};
  Solution before_ = {};  ///< the start was corrected; what it was until the two are compared
  bool compared_ = true;
  int started_ = 0;
  int moved_ = 0;  ///< keyframes, of those
  int corrected_ = 0;
  int left_ = 0;        ///< iterations
  T new_depth_ = T(0);  ///< inverse, of the newest keyframe's own landmarks; 0: not yet known
  T damping_ = kFirstDamping;
  Start start_ = Start::kNoCheck;
  int start_from_ = 0;     ///< index of the keyframe that the start's motion is relative to
  T start_cost_ = T(0);    ///< of the window's motion from it to the newest
  Rigid<T> start_motion_;  ///< another one, translation of length 1
  System system_;
  T gradient_[kMaxStates] = {};
  Reduced reduced_[kLandmarks];
  System reduced_system_;
  Solution trial_ = {};
  Matrix<T, 6, 6> newest_covariance_ = Matrix<T, 6, 6>::Zero();
  FocalBelief<T> belief_;
  Vector<T, 6> by_focal_[kPoses];  ///< how a pose follows from the focal scale
  T focal_sigma_ = T(0);
  T focal_excess_ =
      T(1);  ///< variance of what the window says of it, over that of its pixels alone
  bool anchored_ = false;
  bool solved_ = false;  ///< reduced_system_ holds its factors
};

}  // namespace cairn

#include "cairn/window/detail/keyframe_window_impl.hpp"
#include "cairn/window/detail/window_equations.hpp"
#include "cairn/window/detail/window_iteration.hpp"
#include "cairn/window/detail/window_start.hpp"
#include "cairn/window/detail/window_turns.hpp"
