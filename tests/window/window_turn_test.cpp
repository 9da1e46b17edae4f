#include <gtest/gtest.h>

#include "cairn/window/keyframe_window.hpp"

#include "window_scene.hpp"

namespace cairn {
namespace {

/// GIVEN keyframes of a camera that turns and moves, whose pictures are noisy by `noise` and, with
/// a `variance`, the true turns between them.
template <class T>
struct TurnedDrive {
  using Window = KeyframeWindow<T>;
  using Scene = WindowScene<T>;
  Scene scene;
  Window window;
  int slots[Scene::kPoints];
  Random random{7};

  explicit TurnedDrive(T sigma = T(0.01)) {
    WindowParameters<T> parameters;
    parameters.sigma = sigma;
    parameters.focal_sigma = T(0);
    EXPECT_EQ(window.initialise(parameters), Status::kOk);
  }
  T noise(T sigma) {
    T sum = T(0);
    for (int i = 0; i < 12; ++i) sum += static_cast<T>(1e-6 * random.below(1000000));
    return sigma * (sum - T(6));
  }
  static Quaternion<T> turn(int from, int to) {  // R_from_to
    return Scene::pose(from).rotation * Scene::pose(to).rotation.conjugate();
  }
  void keyframe(int frame, T sigma, T variance) {
    window.begin_keyframe(Scene::pose(frame));
    if (variance > T(0)) window.set_turn(turn(frame - 1, frame), variance);
    for (int i = 0; i < Scene::kPoints; ++i) {
      const Vector2<T> seen =
          scene.seen(i, Scene::pose(frame)) + Vector2<T>{noise(sigma), noise(sigma)};
      if (frame == 0) {
        slots[i] = window.add_landmark(static_cast<LandmarkId>(i + 1), seen);
      } else if (window.used(slots[i])) {
        window.observe(slots[i], seen);
      }
    }
    window.finish_keyframe();
    for (int steps = 0; window.working() && steps < 1000; ++steps) window.step();
  }
  T turn_error(int frame) const {
    const Quaternion<T> off =
        window.newest_pose().rotation * Scene::pose(frame).rotation.conjugate();
    return sqrt(rotation_log(off).squaredNorm());
  }
};

TEST(WindowTurns, HoldTheAttitudeThatTheLandmarksLeaveOpen) {
  TurnedDrive<double> without;
  TurnedDrive<double> with;
  double free = 0.0;
  double held = 0.0;
  for (int k = 0; k < 6; ++k) {
    without.keyframe(k, 0.01, 0.0);
    with.keyframe(k, 0.01, k > 0 ? 1e-8 : 0.0);
    free += without.turn_error(k);
    held += with.turn_error(k);
  }
  EXPECT_GT(free, 0.01);
  EXPECT_LT(held, 0.1 * free);
  // And the window knows: its covariance of the newest attitude is that of five turns.
  EXPECT_NEAR(with.window.newest_covariance()(1, 1), 5e-8, 2e-8);
  EXPECT_GT(without.window.newest_covariance()(1, 1), 1e-6);
}

TEST(WindowTurns, AreJoinedWhereAKeyframeBetweenLeaves) {
  TurnedDrive<double> with;
  for (int k = 0; k < 14; ++k) with.keyframe(k, 0.01, k > 0 ? 1e-8 : 0.0);
  EXPECT_EQ(with.window.keyframes(), KeyframeWindow<double>::kKeyframes);
  EXPECT_LT(with.turn_error(13), 0.003);
}

TEST(WindowTurns, AWrongOneLosesItsWeight) {
  TurnedDrive<double> with(0.0015);
  for (int k = 0; k < 5; ++k) with.keyframe(k, 0.0005, k > 0 ? 1e-6 : 0.0);
  // A turn that is off by 0.3 rad, 300 sigma.
  with.window.begin_keyframe(WindowScene<double>::pose(5));
  const Quaternion<double> wrong = rotation_exp(Vector3<double>(0.3, 0.0, 0.0));
  with.window.set_turn(wrong * TurnedDrive<double>::turn(4, 5), 1e-6);
  for (int i = 0; i < WindowScene<double>::kPoints; ++i) {
    with.window.observe(with.slots[i], with.scene.seen(i, WindowScene<double>::pose(5)));
  }
  with.window.finish_keyframe();
  for (int steps = 0; with.window.working() && steps < 1000; ++steps) with.window.step();
  EXPECT_LT(with.turn_error(5), 0.02);
}

TEST(WindowTurns, NothingHappensInTheFirstKeyframe) {
  TurnedDrive<float> a;
  TurnedDrive<float> b;
  a.window.begin_keyframe(Rigid<float>());
  b.window.begin_keyframe(Rigid<float>());
  b.window.set_turn(rotation_exp(Vector3<float>(1.0F, 0.0F, 0.0F)), 1e-6F);
  for (int i = 0; i < WindowScene<float>::kPoints; ++i) {
    a.slots[i] = a.window.add_landmark(static_cast<LandmarkId>(i + 1), a.scene.seen(i, {}));
    b.slots[i] = b.window.add_landmark(static_cast<LandmarkId>(i + 1), b.scene.seen(i, {}));
  }
  a.window.finish_keyframe();
  b.window.finish_keyframe();
  a.keyframe(1, 0.001F, 0.0F);
  b.keyframe(1, 0.001F, 0.0F);
  Hash64 ha;
  Hash64 hb;
  a.window.hash(ha);
  b.window.hash(hb);
  EXPECT_EQ(ha.value(), hb.value());
}

}  // namespace
}  // namespace cairn
