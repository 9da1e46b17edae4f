#include "cairn/window/keyframe_window.hpp"

#include <gtest/gtest.h>

#include "window_scene.hpp"

namespace cairn {
namespace {

template <class T>
struct Drive {
  using Window = KeyframeWindow<T>;
  using Scene = WindowScene<T>;
  Scene scene;
  Window window;
  int slots[Scene::kPoints];
  int most_steps = 0;
  int mismatched = 0;                        ///< points, from the first
  Vector2<T> mismatch = Vector2<T>::Zero();  ///< of these, beside where they are

  explicit Drive(const WindowParameters<T>& parameters = {}) {
    EXPECT_EQ(window.initialise(parameters), Status::kOk);
  }
  /// A keyframe at a pose that is off by `error`, then all iterations.
  void keyframe(int frame, T error, bool moved = true) {
    const bool first = window.started() == 0;
    Rigid<T> guess = Scene::pose(frame);
    const T step[6] = {error, -error, error, error, error, -error};
    if (frame > 0) guess = perturbed(guess, step);
    window.begin_keyframe(guess);
    for (int i = 0; i < Scene::kPoints; ++i) {
      Vector2<T> seen = scene.seen(i, Scene::pose(frame));
      if (!first && i < mismatched) seen += mismatch;
      if (first) {
        slots[i] = window.add_landmark(static_cast<LandmarkId>(i + 1), seen);
      } else {
        window.observe(slots[i], seen);
      }
    }
    window.finish_keyframe(moved);
    int steps = 0;
    for (; window.working() && steps < 1000; ++steps) window.step();
    most_steps = steps > most_steps ? steps : most_steps;
  }
  /// Largest deviation of depth from the truth once the free scale is taken out.
  T depth_error() const {
    T scale = T(0);
    for (int i = 0; i < Scene::kPoints; ++i) {
      scale += window.inverse_depth(slots[i]) * scene.points[i].z();
    }
    scale /= T(Scene::kPoints);
    T worst = T(0);
    for (int i = 0; i < Scene::kPoints; ++i) {
      const T error = abs(window.inverse_depth(slots[i]) * scene.points[i].z() / scale - T(1));
      worst = error > worst ? error : worst;
    }
    return worst;
  }
  std::uint64_t hash() const {
    Hash64 hash;
    window.hash(hash);
    return hash.value();
  }
};

TEST(KeyframeWindow, FindsTheReliefFromEqualDepths) {
  WindowParameters<double> parameters;
  parameters.iterations = 30;
  parameters.depth_prior_sigma = 50.0;  // next to no prior: nothing pulls at the true depths
  Drive<double> drive(parameters);
  for (int k = 0; k < 6; ++k) drive.keyframe(2 * k, 0.002);
  EXPECT_LT(drive.depth_error(), 1e-3);
}

TEST(KeyframeWindow, FindsItInSinglePrecisionWithThePrior) {
  Drive<float> drive;
  for (int k = 0; k < 7; ++k) drive.keyframe(2 * k, 0.002F);
  EXPECT_LT(drive.depth_error(), 0.03F);
}

TEST(KeyframeWindow, AnAmendedDirectionIsTheNewestKeyframesAlone) {
  Drive<double> drive;
  drive.keyframe(0, 0.0);
  drive.keyframe(3, 0.0);
  Vector2<double> seen;
  const Vector2<double> better(0.1, -0.2);
  const std::uint64_t before = drive.hash();
  drive.window.amend(drive.slots[2], better);
  ASSERT_TRUE(drive.window.newest_sees(drive.slots[2], seen));
  EXPECT_LT((seen - better).norm(), 1e-12);
  EXPECT_EQ(drive.hash(), before);
  // Of a landmark that it sees first, the ray too: at the keyframe itself it is seen there.
  drive.window.begin_keyframe(WindowScene<double>::pose(6));
  const int slot = drive.window.add_landmark(1000, Vector2<double>(0.3, 0.3));
  ASSERT_GE(slot, 0);
  drive.window.amend(slot, better);
  ASSERT_TRUE(drive.window.project(slot, WindowScene<double>::pose(6), seen));
  EXPECT_LT((seen - better).norm(), 1e-9);
  drive.window.amend(drive.slots[2], better);
  EXPECT_FALSE(drive.window.newest_sees(drive.slots[2], seen));
}

/// Depth error after three keyframes that begin in the mirrored world: the camera is believed to
/// have moved the other way and to have turned instead, so that the middle of the relief looks the
/// same.
double error_from_mirrored_start(std::uint64_t seed, int start_keyframes) {
  constexpr double kMean = 0.95;  // inverse depth
  WindowParameters<double> parameters;
  parameters.start_keyframes = start_keyframes;
  Drive<double> drive(parameters);
  drive.scene = WindowScene<double>(seed);
  drive.keyframe(0, 0.0);
  for (const int frame : {3, 6, 9}) {
    const Rigid<double> truth = WindowScene<double>::pose(frame);
    const Vector3<double> moved = truth.translation;
    const double turn[6] = {-2.0 * kMean * moved.y(), 2.0 * kMean * moved.x(), 0, 0, 0, 0};
    Rigid<double> wrong = perturbed(truth, turn);
    wrong.translation = -moved;
    if (frame > 3 && start_keyframes > 0) {  // a tracker goes on from what the window says
      const Rigid<double> step = truth * WindowScene<double>::pose(frame - 3).inverse();
      wrong = step * drive.window.newest_pose();
    }
    drive.window.begin_keyframe(wrong);
    for (int i = 0; i < WindowScene<double>::kPoints; ++i) {
      drive.window.observe(drive.slots[i], drive.scene.seen(i, truth));
    }
    drive.window.finish_keyframe();
    while (drive.window.working()) drive.window.step();
  }
  return drive.depth_error();
}

TEST(KeyframeWindow, LeavesTheMirroredWorldInMostScenes) {
  int wrong_without = 0;
  int wrong_with = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    wrong_without += error_from_mirrored_start(seed, 0) > 0.1 ? 1 : 0;
    wrong_with += error_from_mirrored_start(seed, 8) > 0.1 ? 1 : 0;
  }
  EXPECT_GE(wrong_without, 5);
  EXPECT_LE(wrong_with, 2);
}

TEST(KeyframeWindow, LeavesAPlaneOfWhichTwoPicturesShowTwoMotions) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Drive<double> drive;
    drive.scene = WindowScene<double>(seed);
    for (Vector3<double>& p : drive.scene.points) p /= p.z() + 0.5 * p.x() - 0.3 * p.y();
    for (int k = 0; k < 7; ++k) drive.keyframe(4 * k, 0.01);
    EXPECT_EQ(drive.window.corrected(), 0) << seed;
    EXPECT_LT(drive.depth_error(), 0.1) << seed;
  }
}

TEST(KeyframeWindow, AMismatchDoesNotTakeTheStartOfAPlane) {
  int corrected = 0;
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Drive<double> drive;
    drive.scene = WindowScene<double>(seed);
    for (Vector3<double>& p : drive.scene.points) p /= p.z() + 0.5 * p.x() - 0.3 * p.y();
    drive.mismatched = 1;
    drive.mismatch = Vector2<double>(0.02, 0.05);
    for (int k = 0; k < 2; ++k) drive.keyframe(4 * k, 0.01);
    corrected += drive.window.corrected() > 0 ? 1 : 0;
  }
  EXPECT_EQ(corrected, 0);
}

TEST(KeyframeWindow, KeyframesOfAStandingCameraDoNotSettleTheRelief) {
  Drive<float> drive;
  for (int k = 0; k < 10; ++k) drive.keyframe(0, 0.0F, false);
  EXPECT_FALSE(drive.window.settled());
  for (int k = 0; k < 9; ++k) drive.keyframe(2 * k, 0.002F);
  EXPECT_TRUE(drive.window.settled());
}

TEST(KeyframeWindow, WorkIsBoundedAfterEveryKeyframe) {
  Drive<float> drive;
  const WindowParameters<float> p;
  for (int k = 0; k < 12; ++k) {
    drive.keyframe(k, 0.02F);
    EXPECT_LE(drive.window.keyframes(), WindowBounds::kKeyframes);
  }
  EXPECT_LE(drive.most_steps, p.iterations + 3);  // the start is judged, sought and taken
  EXPECT_EQ(drive.window.started(), 12);
}

TEST(KeyframeWindow, RepeatsItselfToTheBit) {
  Drive<float> a;
  Drive<float> b;
  for (int k = 0; k < 9; ++k) {
    a.keyframe(k, 0.01F);
    b.keyframe(k, 0.01F);
    ASSERT_EQ(a.hash(), b.hash());
  }
  b.keyframe(9, 0.01F);
  EXPECT_NE(a.hash(), b.hash());
}

TEST(KeyframeWindow, LandmarksOutliveTheirHostAndRoomIsBounded) {
  Drive<float> drive;
  for (int k = 0; k < 20; ++k) drive.keyframe(k, 0.001F);
  EXPECT_TRUE(drive.window.live(drive.slots[0]));
  EXPECT_LT(drive.depth_error(), 0.05F);
  int added = 0;
  while (drive.window.add_landmark(1000, Vector2<float>(0.1F, 0.1F)) >= 0) ++added;
  EXPECT_EQ(added, WindowBounds::kLandmarks - WindowScene<float>::kPoints);
}

TEST(KeyframeWindow, ForgetsAWrongObservation) {
  Drive<float> drive;
  for (int k = 0; k < 6; ++k) drive.keyframe(2 * k, 0.001F);
  const float before = drive.window.inverse_depth(drive.slots[3]);
  const Rigid<float> pose = WindowScene<float>::pose(14);
  drive.window.begin_keyframe(pose);
  for (int i = 0; i < WindowScene<float>::kPoints; ++i) {
    Vector2<float> seen = drive.scene.seen(i, pose);
    if (i == 3) seen.x() += 0.05F;
    drive.window.observe(drive.slots[i], seen);
  }
  drive.window.finish_keyframe();
  while (drive.window.working()) drive.window.step();
  Vector2<float> seen;
  EXPECT_FALSE(drive.window.newest_sees(drive.slots[3], seen));
  EXPECT_TRUE(drive.window.newest_sees(drive.slots[4], seen));
  EXPECT_NEAR(drive.window.inverse_depth(drive.slots[3]), before, 0.3F * before);
}

TEST(WindowParameters, RefuseWhatIsImpossible) {
  WindowParameters<float> p;
  EXPECT_EQ(p.validate(), Status::kOk);
  p.sigma = 0.0F;
  EXPECT_EQ(p.validate(), Status::kBadConfig);
  p = {};
  p.iterations = 0;
  KeyframeWindow<float> window;
  EXPECT_EQ(window.initialise(p), Status::kBadConfig);
}

}  // namespace
}  // namespace cairn
