#include <gtest/gtest.h>

#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"

namespace cairn {
namespace {

PinholeCamera<double> distorted_camera() {
  PinholeCamera<double> c;
  c.fx = 500;
  c.fy = 510;
  c.cx = 320;
  c.cy = 240;
  c.k1 = -0.12;
  c.k2 = 0.03;
  c.p1 = 1e-3;
  c.p2 = -5e-4;
  c.width = 640;
  c.height = 480;
  return c;
}

TEST(PinholeCamera, UnprojectInvertsProject) {
  const auto camera = distorted_camera();
  for (int v = 0; v < 480; v += 40) {
    for (int u = 0; u < 640; u += 40) {
      const Vector2<double> pixel(u, v);
      Vector2<double> back;
      ASSERT_TRUE(ok(camera.project(3.0 * camera.unproject(pixel), back)));
      EXPECT_NEAR((back - pixel).norm(), 0.0, 1e-3);
    }
  }
}

TEST(PinholeCamera, JacobianAgreesWithDifferences) {
  const auto camera = distorted_camera();
  const Vector3<double> p(0.4, -0.3, 1.7);
  Vector2<double> pixel;
  Matrix<double, 2, 3> jacobian;
  ASSERT_TRUE(ok(camera.project(p, pixel, jacobian)));
  for (int k = 0; k < 3; ++k) {
    const double step = 1e-6;
    Vector2<double> high, low;
    ASSERT_TRUE(ok(camera.project(p + step * Vector3<double>::Unit(k), high)));
    ASSERT_TRUE(ok(camera.project(p - step * Vector3<double>::Unit(k), low)));
    EXPECT_NEAR(((high - low) / (2 * step) - jacobian.col(k)).norm(), 0.0, 1e-5);
  }
}

TEST(PinholeCamera, RefusesPointsWithoutAPixel) {
  auto camera = distorted_camera();
  Vector2<double> pixel(1, 2);
  EXPECT_EQ(camera.project({0, 0, -1}, pixel), Status::kOutOfView);
  EXPECT_EQ(camera.project({0, 0, 0.01}, pixel), Status::kOutOfView);
  camera.k1 = -0.3;
  camera.k2 = 0;
  EXPECT_EQ(camera.project({2, 2, 1}, pixel), Status::kOutOfView);
  EXPECT_EQ(pixel, Vector2<double>(1, 2));
}

TEST(PinholeCamera, ValidationNamesImpossibleCalibrations) {
  auto camera = distorted_camera();
  EXPECT_TRUE(ok(camera.validate()));
  camera.fx = 0;
  EXPECT_EQ(camera.validate(), Status::kBadConfig);
  camera = distorted_camera();
  camera.cx = 1e9;
  EXPECT_EQ(camera.validate(), Status::kBadConfig);
}

TEST(Rigid, InverseAndCompositionObeyTheGroupLaws) {
  const Rigid<double> a{rotation_exp(Vector3<double>(0.3, -0.8, 1.1)), {1, 2, 3}};
  const Rigid<double> b{rotation_exp(Vector3<double>(-0.2, 0.4, 0.6)), {-4, 0.5, 2}};
  const Vector3<double> p(0.7, -1.3, 2.2);
  EXPECT_NEAR(((a * b) * p - a * (b * p)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((a.inverse() * (a * p) - p).norm(), 0.0, 1e-12);
}

TEST(Rigid, RotationLogInvertsExp) {
  for (const double scale : {1e-9, 1e-4, 0.5, 3.0}) {
    const Vector3<double> phi = scale * Vector3<double>(0.6, -0.64, 0.48);
    EXPECT_NEAR((rotation_log(rotation_exp(phi)) - phi).norm(), 0.0, 1e-9 * (1 + scale));
  }
}

}  // namespace
}  // namespace cairn
