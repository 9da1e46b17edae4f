#include "cairn/geometry/pose_refinement.hpp"

#include <limits>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "cairn/geometry/detail/spd_inverse.hpp"

#include "pose_scene.hpp"

namespace cairn {
namespace {

using test::hash_of;
using test::pose_difference;
using test::PoseScene;

template <class T>
class PoseRefinement : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(PoseRefinement, Scalars, );

template <class T>
Status refine(const PoseScene<T>& scene, const std::vector<PoseObservation<T>>& observations,
              Rigid<T>& pose, PoseEstimate<T>& estimate,
              const PoseRefinementOptions<T>& options = {}, std::uint8_t* flags = nullptr) {
  return refine_pose(scene.camera, observations.data(), static_cast<int>(observations.size()),
                     options, pose, estimate, flags);
}

TEST(PoseJacobian, AgreesWithDifferences) {
  PoseScene<double> scene(3);
  for (const auto& o : scene.observe(20, 0)) {
    Vector2<double> pixel;
    Matrix<double, 2, 6> jacobian;
    ASSERT_TRUE(ok(pose_jacobian(scene.camera, o.p_world, scene.T_world_camera, pixel, jacobian)));
    for (int k = 0; k < 6; ++k) {
      const double h = 1e-6;
      Vector2<double> pixels[2];
      for (int side = 0; side < 2; ++side) {
        Vector<double, 6> step = (side == 0 ? h : -h) * Vector<double, 6>::Unit(k);
        Rigid<double> moved = scene.T_world_camera;
        moved.translation += moved.rotation * Vector3<double>(step.head<3>());
        moved.rotation = moved.rotation * rotation_exp(Vector3<double>(step.tail<3>()));
        Matrix<double, 2, 6> unused;
        ASSERT_TRUE(ok(pose_jacobian(scene.camera, o.p_world, moved, pixels[side], unused)));
      }
      const Vector2<double> numeric = (pixels[0] - pixels[1]) / (2 * h);
      EXPECT_NEAR((numeric - jacobian.col(k)).norm(), 0, 1e-5 * (1 + numeric.norm()));
    }
  }
}

TYPED_TEST(PoseRefinement, RecoversAnExactPose) {
  using T = TypeParam;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    PoseScene<T> scene(seed);
    const auto observations = scene.observe(20, 0);
    Rigid<T> pose = scene.disturbed(0.1, 0.3);
    PoseEstimate<T> estimate;
    ASSERT_EQ(refine(scene, observations, pose, estimate), Status::kOk) << seed;
    const double limit = sizeof(T) == 4 ? 2e-4 : 1e-8;
    EXPECT_LT(pose_difference(scene.T_world_camera, pose).norm(), limit) << seed;
    EXPECT_EQ(estimate.inliers, 20);
    EXPECT_GT(estimate.quality, T(0.9));
    EXPECT_LE(estimate.iterations, 6);
  }
}

TYPED_TEST(PoseRefinement, WrongMatchesDoNotMoveThePose) {
  using T = TypeParam;
  int good = 0;
  for (unsigned seed = 1; seed <= 50; ++seed) {
    PoseScene<T> scene(seed);
    auto observations = scene.observe(40, 0.5);
    scene.corrupt(observations, 12);
    Rigid<T> pose = scene.disturbed(0.03, 0.1);
    PoseEstimate<T> estimate;
    std::uint8_t flags[kMaxPoseObservations] = {};
    if (!ok(refine(scene, observations, pose, estimate, {}, flags))) continue;
    if (pose_difference(scene.T_world_camera, pose).norm() > T(0.02)) continue;
    ++good;
    int wrong = 0;
    for (int i = 0; i < 12; ++i) wrong += flags[i];
    EXPECT_LE(wrong, 1) << seed;
    EXPECT_GE(estimate.inliers, 24) << seed;
  }
  EXPECT_GE(good, 49);
}

TYPED_TEST(PoseRefinement, ConvergesFromAWideBasin) {
  using T = TypeParam;
  PoseRefinementOptions<T> options;
  options.max_iterations = 10;
  int converged = 0;
  for (unsigned seed = 1; seed <= 100; ++seed) {
    PoseScene<T> scene(seed);
    const auto observations = scene.observe(30, 0.5);
    Rigid<T> pose = scene.disturbed(0.25, 0.5);
    PoseEstimate<T> estimate;
    if (ok(refine(scene, observations, pose, estimate, options)) &&
        pose_difference(scene.T_world_camera, pose).norm() < T(0.02)) {
      ++converged;
    }
  }
  EXPECT_GE(converged, 97);
}

TEST(PoseRefinementCovariance, CoversTheErrorOfManyRuns) {
  double nees = 0;
  const int runs = 300;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    PoseScene<double> scene(seed);
    auto observations = scene.observe(25, 0.7);
    for (auto& o : observations) {  // points known to 1 cm only
      const double x = scene.gauss(0.01);
      const double y = scene.gauss(0.01);
      const double z = scene.gauss(0.01);
      o.p_world += Vector3<double>(x, y, z);
      o.covariance = 1e-4 * Matrix3<double>::Identity();
    }
    Rigid<double> pose = scene.disturbed(0.02, 0.05);
    PoseEstimate<double> estimate;
    ASSERT_EQ(refine(scene, observations, pose, estimate), Status::kOk);
    const Vector<double, 6> error = pose_difference(scene.T_world_camera, pose);
    nees += error.dot(estimate.covariance.ldlt().solve(error));
  }
  // Huber weights and the cut at 99 % cost some efficiency, so the mean lies a little above 6.
  EXPECT_GT(nees / runs, 5.4);
  EXPECT_LT(nees / runs, 7.5);
}

TYPED_TEST(PoseRefinement, PriorHoldsWhatThePointsDoNotDetermine) {
  using T = TypeParam;
  PoseScene<T> scene(9);
  const auto observations = scene.observe(2, 0);
  PoseRefinementOptions<T> options;
  options.min_inliers = 1;
  options.use_prior = true;
  options.prior_information = T(1e4) * Matrix<T, 6, 6>::Identity();
  const Rigid<T> start = scene.disturbed(0.005, 0.01);
  Rigid<T> pose = start;
  PoseEstimate<T> estimate;
  ASSERT_EQ(refine(scene, observations, pose, estimate, options), Status::kOk);
  EXPECT_LT(estimate.rms_px, T(0.5));
  EXPECT_LT(pose_difference(start, pose).norm(), T(0.03));

  options.prior_information *= T(1e5);  // a prior of small variance does not move
  pose = start;
  options.inlier_gate = T(1e9);
  ASSERT_EQ(refine(scene, observations, pose, estimate, options), Status::kOk);
  EXPECT_LT(pose_difference(start, pose).norm(), T(1e-4));
}

TYPED_TEST(PoseRefinement, DegenerateGeometryIsRefused) {
  using T = TypeParam;
  PoseScene<T> scene(4);
  std::vector<PoseObservation<T>> observations(6);
  for (int i = 0; i < 6; ++i) {
    const Vector3<T> p_camera(T(0.2) * static_cast<T>(i) - T(0.5), T(0.1), T(3));
    auto& o = observations[static_cast<std::size_t>(i)];
    o.p_world = scene.T_world_camera * p_camera;
    ASSERT_TRUE(ok(scene.camera.project(p_camera, o.pixel)));
  }
  const Rigid<T> before = scene.T_world_camera;
  Rigid<T> pose = before;
  PoseEstimate<T> estimate;
  estimate.inliers = -7;
  EXPECT_EQ(refine(scene, observations, pose, estimate), Status::kDegenerate);
  EXPECT_EQ(hash_of(pose), hash_of(before));
  EXPECT_EQ(estimate.inliers, -7);
}

TYPED_TEST(PoseRefinement, RefusesImpossibleInput) {
  using T = TypeParam;
  PoseScene<T> scene(5);
  const auto observations = scene.observe(10, 0.5);
  Rigid<T> pose = scene.T_world_camera;
  const Rigid<T> before = pose;
  PoseEstimate<T> estimate;
  const PoseRefinementOptions<T> options;
  EXPECT_EQ(refine_pose<T>(scene.camera, nullptr, 10, options, pose, estimate),
            Status::kInvalidArgument);
  EXPECT_EQ(refine_pose<T>(scene.camera, observations.data(), 2, options, pose, estimate),
            Status::kInvalidArgument);
  EXPECT_EQ(refine_pose<T>(scene.camera, observations.data(), kMaxPoseObservations + 1, options,
                           pose, estimate),
            Status::kInvalidArgument);
  auto bad = observations;
  bad[3].sigma_px = T(0);
  EXPECT_EQ(refine(scene, bad, pose, estimate), Status::kInvalidArgument);
  bad = observations;
  bad[3].pixel.x() = std::numeric_limits<T>::quiet_NaN();
  EXPECT_EQ(refine(scene, bad, pose, estimate), Status::kNonFiniteInput);
  Rigid<T> away = scene.T_world_camera;
  away.rotation = away.rotation * rotation_exp(Vector3<T>(T(0), T(3), T(0)));
  EXPECT_EQ(refine(scene, observations, away, estimate), Status::kDegenerate);
  EXPECT_EQ(hash_of(pose), hash_of(before));
}

TYPED_TEST(PoseRefinement, NoiseAloneIsNoConsensus) {
  using T = TypeParam;
  PoseScene<T> scene(6);
  auto observations = scene.observe(30, 0.5);
  scene.corrupt(observations, 30);
  Rigid<T> pose = scene.T_world_camera;
  PoseEstimate<T> estimate;
  PoseRefinementOptions<T> options;
  options.min_inliers = 10;
  EXPECT_EQ(refine(scene, observations, pose, estimate, options), Status::kNoConsensus);
}

TEST(SpdInverse, AgreesWithEigenAndRefusesSingular) {
  std::mt19937 engine(1);
  std::normal_distribution<double> gauss;
  Matrix<double, 6, 6> a;
  for (int i = 0; i < 36; ++i) a.data()[i] = gauss(engine);
  const Matrix<double, 6, 6> spd = a * a.transpose();
  Matrix<double, 6, 6> inverse;
  ASSERT_TRUE(detail::invert_spd(spd, 1e-12, inverse));
  EXPECT_NEAR((inverse * spd - Matrix<double, 6, 6>::Identity()).norm(), 0, 1e-9);
  Matrix<double, 6, 6> singular = spd;
  singular.row(5) = singular.row(4);
  singular.col(5) = singular.col(4);
  EXPECT_FALSE(detail::invert_spd(singular, 1e-11, inverse));
}

}  // namespace
}  // namespace cairn
