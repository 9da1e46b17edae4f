#include "cairn/window/window_pose.hpp"

#include <gtest/gtest.h>

#include "window_scene.hpp"

namespace cairn {
namespace {

using Scene = WindowScene<double>;

/// Sightings of the scene from one pose, hosted by the first camera, exact.
struct Sightings {
  WindowSighting<double> all[Scene::kPoints];

  Sightings(const Scene& scene, const Rigid<double>& T_camera_world) {
    for (int i = 0; i < Scene::kPoints; ++i) {
      all[i].rho = 1.0 / scene.points[i].z();
      all[i].direction = all[i].rho * scene.points[i];
      all[i].sigma = 0.01;
      all[i].seen = scene.seen(i, T_camera_world);
    }
  }
};

double distance(const Rigid<double>& a, const Rigid<double>& b) {
  const Rigid<double> d = a * b.inverse();
  return sqrt(d.translation.squaredNorm()) + sqrt(rotation_log(d.rotation).squaredNorm());
}

TEST(WindowPose, IsExactWithExactSightings) {
  const Rigid<double> truth = Scene::pose(8);
  Sightings sightings{Scene(), truth};
  Rigid<double> pose;
  Matrix<double, 6, 6> covariance;
  EXPECT_EQ(estimate_window_pose(sightings.all, Scene::kPoints, {}, pose, covariance),
            Scene::kPoints);
  EXPECT_LT(distance(pose, truth), 1e-6);
  EXPECT_GT(covariance(0, 0), 0.0);
}

TEST(WindowPose, LeavesOutAThirdOfWrongSightings) {
  const Rigid<double> truth = Scene::pose(5);
  Sightings sightings{Scene(), truth};
  for (int i = 0; i < Scene::kPoints; i += 3) sightings.all[i].seen.y() += i % 2 == 0 ? 0.1 : -0.07;
  Rigid<double> pose = Scene::pose(4);
  Matrix<double, 6, 6> covariance;
  EXPECT_EQ(estimate_window_pose(sightings.all, Scene::kPoints, {}, pose, covariance),
            Scene::kPoints - (Scene::kPoints + 2) / 3);
  EXPECT_LT(distance(pose, truth), 5e-3);
  EXPECT_FALSE(sightings.all[0].inlier);
  EXPECT_TRUE(sightings.all[1].inlier);
}

/// Distance from a camera that only turned to where its blurred pictures place it; the depths are
/// unknown.
double mean_error_of_blurred_turns(const WindowPoseOptions<double>& options) {
  constexpr int kSeeds = 20;
  double sum = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Rigid<double> truth;
    truth.rotation = rotation_exp(Vector3<double>(0.0, 0.02, 0.0));
    Sightings sightings{Scene(static_cast<std::uint64_t>(seed)), truth};
    Random random(static_cast<std::uint64_t>(1000 + seed));
    const auto blur = [&] { return 1e-8 * random.below(2000000) - 0.01; };
    for (WindowSighting<double>& s : sightings.all) {
      s.sigma = 0.5 * s.rho;
      const double x = blur();
      const double y = blur();
      s.seen += Vector2<double>(x, y);
    }
    Rigid<double> pose;
    Matrix<double, 6, 6> covariance;
    EXPECT_GT(estimate_window_pose(sightings.all, Scene::kPoints, options, pose, covariance), 0);
    sum += sqrt(pose.inverse().translation.squaredNorm());
  }
  return sum / kSeeds;
}

TEST(WindowPose, AnExpectedCentreTellsATurnFromAMovement) {
  WindowPoseOptions<double> options;
  const double by_landmarks_alone = mean_error_of_blurred_turns(options);
  options.centre_information = 1.0 / square(0.002);
  EXPECT_LT(mean_error_of_blurred_turns(options), 0.5 * by_landmarks_alone);
}

TEST(WindowPose, AJerkIsBelievedAgainstTheExpectedCentre) {
  const Rigid<double> truth = Scene::pose(8);
  Sightings sightings{Scene(), truth};
  WindowPoseOptions<double> options;
  options.centre_information = 1.0 / square(0.004);
  Rigid<double> pose;
  Matrix<double, 6, 6> covariance;
  EXPECT_EQ(estimate_window_pose(sightings.all, Scene::kPoints, options, pose, covariance),
            Scene::kPoints);
  EXPECT_GT(sqrt(truth.translation.squaredNorm()), 10 * 0.004);
  EXPECT_LT(distance(pose, truth), 0.02 * sqrt(truth.translation.squaredNorm()));
}

TEST(WindowPose, RefusesFewerThanTwoSightings) {
  Sightings sightings{Scene(), Scene::pose(2)};
  Rigid<double> pose;
  Matrix<double, 6, 6> covariance;
  EXPECT_EQ(estimate_window_pose(sightings.all, 0, {}, pose, covariance), -1);
  EXPECT_EQ(distance(pose, Rigid<double>()), 0.0);
}

}  // namespace
}  // namespace cairn
