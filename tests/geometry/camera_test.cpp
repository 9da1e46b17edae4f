#include "cairn/geometry/camera.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace cairn {
namespace {

PinholeCamera<double> lens(double f, double k1, double k2, double k3 = 0.0, double p1 = 0.0,
                           double p2 = 0.0) {
  PinholeCamera<double> c;
  c.width = 640;
  c.height = 480;
  c.fx = f;
  c.fy = 1.01 * f;
  c.cx = 318.5;
  c.cy = 243.0;
  c.k1 = k1;
  c.k2 = k2;
  c.k3 = k3;
  c.p1 = p1;
  c.p2 = p2;
  return c;
}

template <class T>
PinholeCamera<T> cast(const PinholeCamera<double>& c) {
  PinholeCamera<T> out;
  out.fx = static_cast<T>(c.fx);
  out.fy = static_cast<T>(c.fy);
  out.cx = static_cast<T>(c.cx);
  out.cy = static_cast<T>(c.cy);
  out.k1 = static_cast<T>(c.k1);
  out.k2 = static_cast<T>(c.k2);
  out.p1 = static_cast<T>(c.p1);
  out.p2 = static_cast<T>(c.p2);
  out.k3 = static_cast<T>(c.k3);
  out.width = c.width;
  out.height = c.height;
  return out;
}

/// Largest distance between a pixel and the projection of its ray, over the whole image.
template <class T>
double largest_return_px(const PinholeCamera<T>& camera, int step) {
  double worst = 0.0;
  for (int v = 0; v < camera.height; v += step) {
    for (int u = 0; u < camera.width; u += step) {
      const Vector2<T> pixel(static_cast<T>(u), static_cast<T>(v));
      Vector2<T> back;
      if (!ok(camera.project(camera.unproject(pixel), back))) return HUGE_VAL;
      worst = std::max(worst, static_cast<double>((back - pixel).norm()));
    }
  }
  return worst;
}

/// Distorted radius at which the radial polynomial first stops growing, by small steps.
double reach(const PinholeCamera<double>& c) {
  double r = 0.0;
  for (; r < 10.0; r += 1e-4) {
    const double r2 = r * r;
    if (1.0 + r2 * (3.0 * c.k1 + r2 * (5.0 * c.k2 + r2 * 7.0 * c.k3)) <= 0.0) break;
  }
  return r < 10.0 ? r * (1.0 + r * r * (c.k1 + r * r * (c.k2 + r * r * c.k3))) : HUGE_VAL;
}

double corner_radius(const PinholeCamera<double>& c) {
  const double x = std::max(c.cx, c.width - 1 - c.cx) / c.fx;
  const double y = std::max(c.cy, c.height - 1 - c.cy) / c.fy;
  return std::hypot(x, y);
}

TEST(CameraDistortion, EveryPixelOfAWideLensHasItsRay) {
  // Calibrations of lenses on boards and drones, rounded.
  const PinholeCamera<double> lenses[] = {
      lens(458.7, -0.283, 0.074, 0.0, 2e-4, 2e-5), lens(420.0, -0.30, 0.09, -0.011, 1e-3, -1e-3),
      lens(505.0, -0.755, 0.428, 0.0, 0.0037, 0.0), lens(400.0, 0.25, 0.10, 0.05),
      lens(600.0, 0.26, -0.95, 1.16, -0.0054, 0.0026)};
  for (const PinholeCamera<double>& camera : lenses) {
    ASSERT_TRUE(ok(camera.validate())) << camera.k1;
    EXPECT_LT(largest_return_px(camera, 3), 1e-3) << camera.k1;
    const PinholeCamera<float> rounded = cast<float>(camera);
    ASSERT_TRUE(ok(rounded.validate())) << camera.k1;
    EXPECT_LT(largest_return_px(rounded, 3), 0.05) << camera.k1;
  }
}

TEST(CameraDistortion, AFocalLengthOfNoPictureIsRefused) {
  for (const double focal : {1e-3, 1e-30, 1e9, 1e30}) {
    for (const bool both : {false, true}) {
      PinholeCamera<double> camera = lens(500.0, 0.0, 0.0);
      camera.fy = focal;
      if (both) camera.fx = focal;
      EXPECT_EQ(camera.validate(), Status::kBadConfig) << focal;
      EXPECT_EQ(cast<float>(camera).validate(), Status::kBadConfig) << focal;
    }
  }
}

TEST(CameraFocalScale, KeepsThePixelsOfNarrowerRays) {
  PinholeCamera<double> camera = lens(500.0, 0.2, -0.6, 0.5, 0.001, -0.002);
  for (const bool rational : {false, true}) {
    if (rational) {
      camera.k4 = 0.05;
      camera.k5 = -0.02;
      camera.k6 = 0.01;
    }
    for (const double scale : {0.8, 1.0, 1.15}) {
      const PinholeCamera<double> scaled = camera.with_focal_scale(scale);
      for (const double x : {-0.5, 0.1, 0.4}) {
        Vector2<double> told;
        Vector2<double> pixel;
        ASSERT_TRUE(ok(camera.project(Vector3<double>(scale * x, scale * 0.3, 1.0), told)));
        ASSERT_TRUE(ok(scaled.project(Vector3<double>(x, 0.3, 1.0), pixel)));
        EXPECT_LT((pixel - told).norm(), 1e-9);
      }
    }
  }
}

TEST(CameraDistortion, ALensThatFoldsInsideTheImageIsRefused) {
  const PinholeCamera<double> lenses[] = {lens(300.0, -0.30, 0.0),  // folds at 46 degrees
                                          lens(400.0, -0.405, 0.267, -0.130),
                                          lens(250.0, -0.5, 0.1)};
  for (const PinholeCamera<double>& camera : lenses) {
    EXPECT_EQ(camera.validate(), Status::kBadConfig) << camera.k1;
    EXPECT_EQ(cast<float>(camera).validate(), Status::kBadConfig) << camera.k1;
    Vector3<double> ray;
    EXPECT_EQ(camera.unproject({0.0, 0.0}, ray), Status::kOutOfView);
    EXPECT_TRUE(std::isfinite(ray.x()) && std::isfinite(ray.y()));
    EXPECT_TRUE(ok(camera.unproject({camera.cx + 20.0, camera.cy}, ray)));
  }
}

TEST(CameraDistortion, ValidationKnowsTheFoldOfAnyPolynomial) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> focal(250.0, 900.0), k1(-0.8, 0.6), k2(-0.6, 0.6),
      k3(-0.3, 0.3);
  int accepted = 0;
  constexpr int kLenses = 3000;
  for (int i = 0; i < kLenses; ++i) {
    const double drawn[] = {focal(random), k1(random), k2(random), k3(random)};
    const PinholeCamera<double> camera = lens(drawn[0], drawn[1], drawn[2], drawn[3]);
    const double margin = reach(camera) / corner_radius(camera);
    if (margin > 0.999 && margin < 1.001) continue;  // the fold is at the corner
    const bool good = ok(camera.validate());
    EXPECT_EQ(good, margin > 1.0) << camera.k1 << ' ' << camera.k2 << ' ' << camera.k3;
    accepted += good ? 1 : 0;
    if (good) {
      EXPECT_LT(largest_return_px(camera, 37), 1e-3);
    }
  }
  EXPECT_GT(accepted, kLenses / 10);
  EXPECT_LT(accepted, kLenses * 9 / 10);
}

TEST(CameraDistortion, APointBeyondTheFoldHasNoPixel) {
  // Slope 1 - 1.5 r^2 + 0.5 r^4: it falls from r = 1 to sqrt 2 and grows again behind.
  const PinholeCamera<double> camera = lens(700.0, -0.5, 0.1);
  ASSERT_TRUE(ok(camera.validate()));
  Vector2<double> pixel(1.0, 2.0);
  EXPECT_TRUE(ok(camera.project({0.99, 0.0, 1.0}, pixel)));
  pixel = {1.0, 2.0};
  EXPECT_EQ(camera.project({1.2, 0.0, 1.0}, pixel), Status::kOutOfView);
  EXPECT_EQ(camera.project({1.73, 0.0, 1.0}, pixel), Status::kOutOfView);
  EXPECT_EQ(pixel, Vector2<double>(1.0, 2.0));
}

TEST(CameraDistortion, PixelsFarOutsideTheImageGiveAFiniteRay) {
  for (const double k1 : {-0.3, 0.3, -0.755}) {
    const PinholeCamera<double> camera = lens(458.0, k1, k1 < -0.5 ? 0.428 : 0.07, 0.0, 1e-3, 1e-3);
    for (const double u : {-1e9, -3000.0, 5000.0, 1e9}) {
      const Vector3<double> ray = camera.unproject({u, 0.5 * u});
      EXPECT_TRUE(std::isfinite(ray.x()) && std::isfinite(ray.y())) << k1 << ' ' << u;
    }
  }
}

}  // namespace
}  // namespace cairn
