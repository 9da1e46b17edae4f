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

TEST(WindowPose, RefusesFewerThanTwoSightings) {
  Sightings sightings{Scene(), Scene::pose(2)};
  Rigid<double> pose;
  Matrix<double, 6, 6> covariance;
  EXPECT_EQ(estimate_window_pose(sightings.all, 0, {}, pose, covariance), -1);
  EXPECT_EQ(distance(pose, Rigid<double>()), 0.0);
}

}  // namespace
}  // namespace cairn
