#include "cairn/geometry/p3p.hpp"

#include <cstring>
#include <limits>

#include <gtest/gtest.h>

#include "pose_scene.hpp"

namespace cairn {
namespace {

using test::pose_difference;
using test::PoseScene;

template <class T>
class P3p : public ::testing::Test {};
using Scalars = ::testing::Types<float, double>;
TYPED_TEST_SUITE(P3p, Scalars, );

template <class T>
struct Triangle {
  Vector3<T> p_world[3];
  Vector3<T> bearing[3];
};

template <class T>
Triangle<T> random_triangle(PoseScene<T>& scene) {
  Triangle<T> triangle;
  for (int i = 0; i < 3; ++i) {
    const T x = scene.uniform(-0.6, 0.6);
    const T y = scene.uniform(-0.45, 0.45);
    const T depth = scene.uniform(1.5, 8);
    const Vector3<T> ray(x, y, T(1));
    triangle.bearing[i] = scene.uniform(0.5, 2) * ray;
    triangle.p_world[i] = scene.T_world_camera * Vector3<T>(depth * ray);
  }
  return triangle;
}

TYPED_TEST(P3p, TheTruePoseIsAmongTheSolutions) {
  using T = TypeParam;
  const int runs = 20000;
  const double limit = sizeof(T) == 4 ? 2e-2 : 1e-7;
  int missed = 0;
  int refused = 0;
  int spurious = 0;
  PoseScene<T> scene(1);
  for (int run = 0; run < runs; ++run) {
    scene.T_world_camera = scene.random_pose();
    const Triangle<T> triangle = random_triangle(scene);
    P3pSolutions<T> solutions;
    const Status status = solve_p3p(triangle.p_world, triangle.bearing, solutions);
    if (status == Status::kDegenerate) {
      ++refused;
      continue;
    }
    double best = 1e9;
    for (int s = 0; s < solutions.count; ++s) {
      const Rigid<T>& pose = solutions.T_world_camera[s];
      best = std::min<double>(best, pose_difference(scene.T_world_camera, pose).norm());
      for (int i = 0; i < 3; ++i) {  // every solution must see the points along the bearings
        const Vector3<T> p = pose.inverse() * triangle.p_world[i];
        if (p.normalized().cross(triangle.bearing[i].normalized()).norm() > T(limit)) ++spurious;
      }
    }
    if (!(best < limit)) ++missed;
  }
  EXPECT_LE(refused, runs / 100);
  EXPECT_EQ(spurious, 0);
  // What remains lies on the danger cylinder, where two solutions merge.
  EXPECT_LE(missed, sizeof(T) == 4 ? runs / 200 : runs / 10000);
}

TYPED_TEST(P3p, SymmetricPyramidHasItsFourSolutions) {
  using T = TypeParam;
  // Legs of 2, base sides of sqrt(3): four solutions (Fischler and Bolles 1981, appendix A).
  const T r = T(1);
  Vector3<T> p_world[3];
  Vector3<T> bearing[3];
  for (int i = 0; i < 3; ++i) {
    T s{}, c{};
    sin_cos(kTwoPi<T> / T(3) * static_cast<T>(i), s, c);
    p_world[i] = Vector3<T>(r * c, r * s, T(0));
    bearing[i] = Vector3<T>(r * c, r * s, sqrt(T(3)));
  }
  P3pSolutions<T> solutions;
  ASSERT_EQ(solve_p3p(p_world, bearing, solutions), Status::kOk);
  bool found = false;
  for (int s = 0; s < solutions.count; ++s) {
    const Vector3<T> t = solutions.T_world_camera[s].translation;
    found = found || (t - Vector3<T>(T(0), T(0), -sqrt(T(3)))).norm() < T(1e-3);
  }
  EXPECT_TRUE(found);
  EXPECT_EQ(solutions.count, 4);
}

TYPED_TEST(P3p, DegenerateInputIsRefusedAndNothingIsChanged) {
  using T = TypeParam;
  P3pSolutions<T> solutions;
  solutions.count = 77;
  const Vector3<T> rays[3] = {{T(0.1), T(0), T(1)}, {T(-0.3), T(0.2), T(1)}, {T(0), T(-0.4), T(1)}};
  const Vector3<T> collinear[3] = {{T(0), T(0), T(0)}, {T(1), T(2), T(3)}, {T(2), T(4), T(6)}};
  EXPECT_EQ(solve_p3p(collinear, rays, solutions), Status::kDegenerate);
  const Vector3<T> same[3] = {{T(1), T(1), T(1)}, {T(1), T(1), T(1)}, {T(2), T(4), T(6)}};
  EXPECT_EQ(solve_p3p(same, rays, solutions), Status::kDegenerate);
  const Vector3<T> good[3] = {{T(0), T(0), T(0)}, {T(1), T(0), T(0)}, {T(0), T(1), T(0)}};
  const Vector3<T> one_ray[3] = {rays[0], T(2) * rays[0], rays[2]};
  EXPECT_EQ(solve_p3p(good, one_ray, solutions), Status::kDegenerate);
  const Vector3<T> nan_ray[3] = {
      rays[0], rays[1], {std::numeric_limits<T>::quiet_NaN(), T(0), T(1)}};
  EXPECT_EQ(solve_p3p(good, nan_ray, solutions), Status::kNonFiniteInput);
  EXPECT_EQ(solutions.count, 77);
}

}  // namespace
}  // namespace cairn
