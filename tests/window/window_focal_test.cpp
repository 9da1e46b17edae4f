#include <gtest/gtest.h>

#include "cairn/window/keyframe_window.hpp"

#include "window_scene.hpp"

namespace cairn {
namespace {

/// A camera whose focal length is `truth` times what it is told, moved through the scene.
template <class T>
struct Zoomed {
  WindowScene<T> scene;
  KeyframeWindow<T> window;
  T truth;
  int slots[WindowScene<T>::kPoints];

  Zoomed(T truth_, T sigma) : truth(truth_) {
    WindowParameters<T> parameters;
    parameters.focal_sigma = sigma;
    EXPECT_EQ(window.initialise(parameters), Status::kOk);
  }
  /// What a keyframe at `pose` measures, by the focal length as it is estimated.
  Vector2<T> measured(int point, const Rigid<T>& pose) const {
    return truth / window.focal_scale() * scene.seen(point, pose);
  }
  void keyframe(const Rigid<T>& pose) {
    const bool first = window.started() == 0;
    window.begin_keyframe(first ? pose : window.newest_pose());
    for (int i = 0; i < WindowScene<T>::kPoints; ++i) {
      if (first) {
        slots[i] = window.add_landmark(static_cast<LandmarkId>(i + 1), measured(i, pose));
      } else {
        window.observe(slots[i], measured(i, pose));
      }
    }
    window.finish_keyframe();
    for (int steps = 0; window.working() && steps < 1000; ++steps) window.step();
  }
};

constexpr double kTold = 0.2;  // standard deviation of a guess

/// Sideways, and turned about all axes.
template <class T = double>
Rigid<T> turned_pose(int k) {
  const T t = static_cast<T>(k);
  Rigid<T> T_world_camera;
  T_world_camera.rotation = rotation_exp(Vector3<T>(T(0.02) * t, T(-0.05) * t, T(0.03) * t));
  T_world_camera.translation = Vector3<T>(T(0.06) * t, T(0.025) * t, T(-0.016) * t);
  return T_world_camera.inverse();
}
Rigid<double> shifted_pose(int k) {
  Rigid<double> T_world_camera = turned_pose(k).inverse();
  T_world_camera.rotation = Quaternion<double>::Identity();
  return T_world_camera.inverse();
}

TEST(WindowFocal, IsFoundWhereTheCameraTurnsAndMoves) {
  for (const double truth : {0.85, 0.95, 1.0, 1.1, 1.2}) {
    Zoomed<double> run(truth, kTold);
    for (int k = 0; k < 7; ++k) run.keyframe(turned_pose(k));
    EXPECT_NEAR(run.window.focal_scale(), truth, 0.2 * kTold) << truth;
    EXPECT_LT(run.window.focal_sigma(), 0.5 * kTold) << truth;
    EXPECT_LT(abs(run.window.focal_scale() - truth), 3.0 * run.window.focal_sigma()) << truth;
  }
}

/// Without a turn, depths stretched along the view explain another focal length as well.
TEST(WindowFocal, StaysAsToldWhereTheCameraDoesNotTurn) {
  Zoomed<double> run(1.1, 0.05);
  for (int k = 0; k < 7; ++k) run.keyframe(shifted_pose(k));
  EXPECT_NEAR(run.window.focal_scale(), 1.0, 0.03);
  EXPECT_GT(run.window.focal_sigma(), 0.04);
}

TEST(WindowFocal, IsKeptWhenTheWindowBeginsAnew) {
  Zoomed<double> run(1.1, kTold);
  for (int k = 0; k < 8; ++k) run.keyframe(turned_pose(k));
  const double learnt = run.window.focal_scale();
  run.window.clear();
  EXPECT_NEAR(run.window.focal_scale(), learnt, 0.03);
  for (int k = 0; k < 7; ++k) run.keyframe(shifted_pose(k));
  EXPECT_NEAR(run.window.focal_scale(), learnt, 0.03);
  EXPECT_LT(run.window.focal_sigma(), 0.5 * kTold);
}

/// The result is then that of a window without this state, to the bit: the hash is of one.
TEST(WindowFocal, IsNoStateWhereItIsKnown) {
  Zoomed<float> run(1.1F, 0.0F);
  for (int k = 0; k < 12; ++k) run.keyframe(turned_pose<float>(k));
  EXPECT_EQ(run.window.focal_scale(), 1.0F);
  EXPECT_EQ(run.window.focal_sigma(), 0.0F);
  Hash64 hash;
  run.window.hash(hash);
  EXPECT_EQ(hash.value(), 0x1cb4477d52d216ebULL);
}

/// Where the newest keyframe is believed to be by a camera that is told `told` and does not doubt
/// it.
Rigid<double> newest_pose_if(double truth, double told, int keyframes) {
  Zoomed<double> run(truth / told, 0.0);
  for (int k = 0; k < keyframes; ++k) run.keyframe(turned_pose(k));
  return run.window.newest_pose();
}

/// Also where the window has slid: poses that are fixed follow the focal length as they would have.
TEST(WindowFocal, TellsHowTheNewestPoseFollows) {
  constexpr double kStep = 0.02;
  for (const int keyframes : {6, 11}) {
    Zoomed<double> run(1.0, 0.05);
    for (int k = 0; k < keyframes; ++k) run.keyframe(turned_pose(k));
    const Rigid<double> low = newest_pose_if(1.0, 1.0 - kStep, keyframes);
    const Rigid<double> high = newest_pose_if(1.0, 1.0 + kStep, keyframes);
    const Vector3<double> expected =
        rotation_log(high.rotation * low.rotation.conjugate()) / (2.0 * kStep);
    const Vector3<double> follows = run.window.newest_by_focal().head<3>();
    EXPECT_GT(expected.norm(), 0.1) << keyframes;
    EXPECT_LT((follows - expected).norm(), 0.3 * expected.norm()) << keyframes;
  }
}

}  // namespace
}  // namespace cairn
