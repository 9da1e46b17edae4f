#pragma once

#include <cstdint>

#include "cairn/base/fixed_vector.hpp"
#include "cairn/estimation/observation.hpp"
#include "cairn/numeric/math.hpp"
#include "cairn/window/inverse_depth_view.hpp"

namespace cairn {

/// A landmark of a KeyframeWindow: a point on a ray of its host, the keyframe that saw it first.
template <class T>
struct WindowLandmark {
  LandmarkId id = kNoLandmark;
  Vector2<T> ray = Vector2<T>::Zero();  ///< as WindowSolution::as_told()
  T prior = T(0);                       ///< of the inverse depth
  T prior_sigma = T(0);
  T sigma = T(0);            ///< of the inverse depth, as it is estimated
  std::int8_t host = -1;     ///< slot of a pose
  std::uint8_t seen = 0;     ///< a bit per place in the window
  std::uint8_t doubted = 0;  ///< same; known to the start's check alone
  bool used = false;
  bool live = false;  ///< still followed

  bool seen_at(int place) const { return ((seen >> place) & 1) != 0; }
  /// Seen, or doubted.
  bool shown_at(int place) const { return (((seen | doubted) >> place) & 1) != 0; }
  int observers() const {
    int count = 0;
    for (unsigned places = seen; places != 0; places >>= 1U) count += static_cast<int>(places & 1U);
    return count;
  }
};

/// What a KeyframeWindow estimates, all that an iteration changes.
template <class T, class Bounds>
struct WindowSolution {
  Rigid<T> pose[Bounds::kPoses];  ///< T_camera_world
  T rho[Bounds::kLandmarks];      ///< inverse depths in the hosts
  T focal = T(1);                 ///< focal length, as a factor on the one that was told

  /// Directions by the focal length as told, and as it is estimated.
  Vector2<T> as_told(const Vector2<T>& direction) const { return focal * direction; }
  Vector2<T> as_estimated(const Vector2<T>& told) const { return T(1) / focal * told; }
};

/// Which keyframes and landmarks a KeyframeWindow has, which keyframe saw which landmark where, and
/// how it was turned from the one before. A keyframe has a *place* in the window while it is in it,
/// and a *pose* among the solution's as long as it hosts landmarks.
template <class T, class Bounds>
class WindowGraph {
 public:
  static constexpr int kKeyframes = Bounds::kKeyframes;
  static constexpr int kLandmarks = Bounds::kLandmarks;
  static constexpr int kPoses = Bounds::kPoses;
  static constexpr int kMaxStates = 6 * (kKeyframes - 1) + 1;  ///< the last: the focal length
  static_assert(kKeyframes >= 3 && kKeyframes <= 8, "observations are flagged in a byte");
  static_assert(kPoses > kKeyframes && kPoses <= 127 && kLandmarks <= 1024, "bounds");

  using Landmark = WindowLandmark<T>;
  using Solution = WindowSolution<T, Bounds>;
  using Places = FixedVector<std::int8_t, kKeyframes>;
  /// How a keyframe is turned from the one before it in the window, by a gyroscope.
  struct Turn {
    bool known = false;
    Quaternion<T> rotation = Quaternion<T>(T(1), T(0), T(0), T(0));  ///< R_present_before
    T variance = T(1);
  };
  /// The landmarks of a host, and the places in the window that see some of them.
  struct Hosted {
    std::int16_t slots[kLandmarks];
    int count = 0;
    std::uint8_t seen = 0;
  };
  struct Size {
    int landmarks = 0;
    int observations = 0;
    int pairs = 0;  ///< of a host and a keyframe that sees some of its landmarks
  };

  void clear();

  // Keyframes.
  const Places& places() const { return order_; }  ///< oldest first
  int keyframes() const { return order_.size(); }
  /// Keyframes since clear().
  int started() const { return started_; }
  int pose_of(int place) const { return slot_of_[place]; }
  int pose_at(int index) const { return slot_of_[order_[index]]; }
  int newest() const { return slot_of_[order_.back()]; }  ///< pose
  /// The place of a pose in the window, -1 for a host that has left it.
  int place_of(int pose) const;
  bool pose_used(int pose) const { return pose_used_[pose]; }
  /// Begins a keyframe; its pose. Domain: the window is not full.
  int add_keyframe();
  /// A pose for a host. With none free, the host outside the window with the fewest landmarks is
  /// given up, and they with it.
  int take_pose();
  /// Index of the keyframe to drop before one at `newest`: one that sees next to nothing of what is
  /// followed, else the one with the largest distance score. The newest stays.
  int worst_keyframe(const Solution& solution, const Rigid<T>& newest) const;
  void drop(int index);
  /// The newest keyframe's; nothing happens in the first one.
  void set_turn(const Quaternion<T>& R_present_before, T variance);
  const Turn& turn_at(int index) const { return turns_[order_[index]]; }

  // States of the equations: six of each pose but for the fixed ones.
  int fixed() const { return started_ > kKeyframes ? 2 : 1; }
  int pose_states() const { return order_.size() > fixed() ? 6 * (order_.size() - fixed()) : 0; }
  /// First state of each place's pose, -1 for those that are fixed.
  void number_states(int* states) const;

  // Landmarks.
  const Landmark& landmark(int slot) const { return landmarks_[slot]; }
  Landmark& landmark(int slot) { return landmarks_[slot]; }
  /// Its slot, -1 when full.
  int add_landmark(const Landmark& landmark);
  void forget_unused();
  /// What is doubted is seen.
  void trust_doubted();
  Hosted hosted_by(int host) const;
  Size size() const;

  // Observations; directions are as told.
  const Vector2<T>& observed(int place, int slot) const { return observed_[place][slot]; }
  /// The newest keyframe sees a landmark.
  void observe(int slot, const Vector2<T>& told);
  void doubt(int slot, const Vector2<T>& told);
  /// Where the newest keyframe saw a landmark, if it did, is known better now.
  void amend(int slot, const Vector2<T>& told);
  bool newest_sees(int slot) const {
    return landmarks_[slot].used && landmarks_[slot].seen_at(order_.back());
  }

  /// How a camera sees a landmark by a solution. False where it is behind it.
  bool view(const Solution& solution, int slot, const Rigid<T>& T_camera_world,
            InverseDepthView<T>& view) const {
    const Landmark& landmark = landmarks_[slot];
    const CameraStep<T> step(solution.pose[landmark.host], T_camera_world);
    return view.project(step, solution.as_estimated(landmark.ray), solution.rho[slot]);
  }
  /// Inverse depth in a camera; 0 where the landmark is behind it.
  T inverse_depth_in(const Solution& solution, int slot, const Rigid<T>& T_camera_world) const {
    InverseDepthView<T> seen;
    return view(solution, slot, T_camera_world, seen) ? solution.rho[slot] / seen.p.z() : T(0);
  }

 private:
  int free_place() const;
  void join_turns(int index);

  Landmark landmarks_[kLandmarks] = {};
  Vector2<T> observed_[kKeyframes][kLandmarks];
  Places order_;
  std::int8_t slot_of_[kKeyframes] = {};  ///< place to pose
  Turn turns_[kKeyframes] = {};           ///< of each place
  bool pose_used_[kPoses] = {};
  int started_ = 0;
};

}  // namespace cairn

#include "cairn/window/detail/window_graph_impl.hpp"
