#include "cairn/geometry/pose_ransac.hpp"

#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "pose_scene.hpp"

namespace cairn {
namespace {

using test::hash_of;
using test::pose_difference;
using test::PoseScene;

template <class T>
class PoseRansac : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(PoseRansac, Scalars, );

template <class T>
struct Run {
  Status status;
  Rigid<T> pose;
  PoseEstimate<T> estimate;
  PoseRansacReport<T> report;
  std::uint8_t flags[kMaxPoseObservations] = {};
};

template <class T>
Run<T> run(const PoseScene<T>& scene, const std::vector<PoseObservation<T>>& observations,
           std::uint64_t seed, const PoseRansacOptions<T>& options = {}) {
  Run<T> r;
  Random random(seed);
  r.status =
      estimate_pose_ransac(scene.camera, observations.data(), static_cast<int>(observations.size()),
                           options, random, r.pose, r.estimate, r.report, r.flags);
  return r;
}

TYPED_TEST(PoseRansac, HalfOfTheMatchesMayBeWrong) {
  using T = TypeParam;
  int found = 0;
  for (unsigned seed = 1; seed <= 200; ++seed) {
    PoseScene<T> scene(seed);
    auto observations = scene.observe(60, 0.7);
    scene.corrupt(observations, 30);
    const Run<T> r = run(scene, observations, seed);
    if (r.status != Status::kOk) continue;
    const auto error = pose_difference(scene.T_world_camera, r.pose);
    EXPECT_LT(error.norm(), T(0.05)) << seed;
    EXPECT_GE(r.estimate.inliers, 24) << seed;
    EXPECT_FALSE(r.report.ambiguous) << seed;
    EXPECT_LE(r.report.hypotheses, 128);
    ++found;
  }
  EXPECT_GE(found, 199);
}

TYPED_TEST(PoseRansac, CleanMatchesNeedFewSamples) {
  using T = TypeParam;
  PoseScene<T> scene(3);
  const Run<T> r = run(scene, scene.observe(40, 0.2), 1);
  ASSERT_EQ(r.status, Status::kOk);
  EXPECT_LE(r.report.hypotheses, 8);
  EXPECT_LT(pose_difference(scene.T_world_camera, r.pose).norm(), T(0.01));
}

TYPED_TEST(PoseRansac, NoiseAloneNeverGivesAPose) {
  using T = TypeParam;
  for (unsigned seed = 1; seed <= 60; ++seed) {
    PoseScene<T> scene(seed);
    auto observations = scene.observe(60, 0.5);
    scene.corrupt(observations, 60);
    EXPECT_EQ(run(scene, observations, seed).status, Status::kNoConsensus) << seed;
  }
}

TYPED_TEST(PoseRansac, CollinearPointsAreRefusedAndNothingIsChanged) {
  using T = TypeParam;
  PoseScene<T> scene(2);
  std::vector<PoseObservation<T>> observations(12);
  for (int i = 0; i < 12; ++i) {
    auto& o = observations[static_cast<std::size_t>(i)];
    const Vector3<T> p_camera(T(0.15) * static_cast<T>(i) - T(0.9), T(0.2), T(3));
    o.p_world = scene.T_world_camera * p_camera;
    ASSERT_TRUE(ok(scene.camera.project(p_camera, o.pixel)));
  }
  Rigid<T> pose = scene.random_pose();
  const Rigid<T> before = pose;
  PoseEstimate<T> estimate;
  PoseRansacReport<T> report;
  Random random(1);
  EXPECT_EQ(estimate_pose_ransac(scene.camera, observations.data(), 12, {}, random, pose, estimate,
                                 report),
            Status::kDegenerate);
  EXPECT_EQ(hash_of(pose), hash_of(before));
  EXPECT_EQ(report.hypotheses, 128);
}

TYPED_TEST(PoseRansac, TheSameSeedGivesTheSameBytes) {
  using T = TypeParam;
  PoseScene<T> scene(8);
  auto observations = scene.observe(50, 0.5);
  scene.corrupt(observations, 20);
  const Run<T> first = run(scene, observations, 42);
  const Run<T> again = run(scene, observations, 42);
  ASSERT_EQ(first.status, Status::kOk);
  EXPECT_EQ(hash_of(first.pose), hash_of(again.pose));
  EXPECT_EQ(std::memcmp(first.flags, again.flags, sizeof first.flags), 0);
  EXPECT_EQ(first.report.hypotheses, again.report.hypotheses);
}

TYPED_TEST(PoseRansac, ASecondPlaceWithTheSameLookIsReported) {
  using T = TypeParam;
  // Two places that look alike: each pixel is matched to a point at both.
  PoseScene<T> scene(11);
  auto observations = scene.observe(20, 0.3);
  const Vector3<T> shift(T(40), T(0), T(0));
  const std::size_t count = observations.size();
  for (std::size_t i = 0; i < count; ++i) {
    auto twin = observations[i];
    twin.p_world += shift;
    observations.push_back(twin);
  }
  int noticed = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const Run<T> r = run(scene, observations, seed);
    ASSERT_EQ(r.status, Status::kOk);
    if (!r.report.ambiguous) continue;
    ++noticed;
    const T apart = (r.report.T_world_camera_second.translation - r.pose.translation).norm();
    EXPECT_NEAR(apart, T(40), T(1));
  }
  EXPECT_GE(noticed, 48);
}

TYPED_TEST(PoseRansac, RefusesImpossibleInput) {
  using T = TypeParam;
  PoseScene<T> scene(2);
  auto observations = scene.observe(10, 0.5);
  PoseRansacOptions<T> options;
  options.confidence = T(1);
  EXPECT_EQ(run(scene, observations, 1, options).status, Status::kInvalidArgument);
  options = {};
  options.inlier_px = T(0);
  EXPECT_EQ(run(scene, observations, 1, options).status, Status::kInvalidArgument);
  observations[4].p_world.y() = std::numeric_limits<T>::infinity();
  EXPECT_EQ(run(scene, observations, 1).status, Status::kNonFiniteInput);
  observations.resize(3);
  EXPECT_EQ(run(scene, observations, 1).status, Status::kInvalidArgument);
}

}  // namespace
}  // namespace cairn
