// The fisheye and the rational lens of PinholeCamera.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "cairn/geometry/camera.hpp"

namespace cairn {
namespace {

PinholeCamera<double> camera(int width, int height, double f) {
  PinholeCamera<double> c;
  c.width = width;
  c.height = height;
  c.fx = f;
  c.fy = 1.01 * f;
  c.cx = 0.5 * width - 1.5;
  c.cy = 0.5 * height + 3.0;
  return c;
}

PinholeCamera<double> fisheye(int width, int height, double f, double k1, double k2, double k3,
                              double k4) {
  PinholeCamera<double> c = camera(width, height, f);
  c.lens = Lens::kFisheye;
  c.k1 = k1;
  c.k2 = k2;
  c.k3 = k3;
  c.k4 = k4;
  return c;
}

PinholeCamera<double> rational(double f, double k1, double k2, double p1, double p2, double k3,
                               double k4, double k5, double k6) {
  PinholeCamera<double> c = camera(640, 480, f);
  c.k1 = k1;
  c.k2 = k2;
  c.p1 = p1;
  c.p2 = p2;
  c.k3 = k3;
  c.k4 = k4;
  c.k5 = k5;
  c.k6 = k6;
  return c;
}

template <class T>
PinholeCamera<T> cast(const PinholeCamera<double>& c) {
  PinholeCamera<T> out;
  const std::pair<T PinholeCamera<T>::*, double PinholeCamera<double>::*> members[] = {
      {&PinholeCamera<T>::fx, &PinholeCamera<double>::fx},
      {&PinholeCamera<T>::fy, &PinholeCamera<double>::fy},
      {&PinholeCamera<T>::cx, &PinholeCamera<double>::cx},
      {&PinholeCamera<T>::cy, &PinholeCamera<double>::cy},
      {&PinholeCamera<T>::k1, &PinholeCamera<double>::k1},
      {&PinholeCamera<T>::k2, &PinholeCamera<double>::k2},
      {&PinholeCamera<T>::k3, &PinholeCamera<double>::k3},
      {&PinholeCamera<T>::k4, &PinholeCamera<double>::k4},
      {&PinholeCamera<T>::k5, &PinholeCamera<double>::k5},
      {&PinholeCamera<T>::k6, &PinholeCamera<double>::k6},
      {&PinholeCamera<T>::p1, &PinholeCamera<double>::p1},
      {&PinholeCamera<T>::p2, &PinholeCamera<double>::p2}};
  for (const auto& [to, from] : members) out.*to = static_cast<T>(c.*from);
  out.lens = c.lens;
  out.width = c.width;
  out.height = c.height;
  return out;
}

/// Largest distance between a pixel and the projection of its ray, over the whole image.
template <class T>
double largest_return_px(const PinholeCamera<T>& c, int step) {
  double worst = 0.0;
  for (int v = 0; v < c.height; v += step) {
    for (int u = 0; u < c.width; u += step) {
      const Vector2<T> pixel(static_cast<T>(u), static_cast<T>(v));
      Vector3<T> ray;
      Vector2<T> back;
      if (!ok(c.unproject(pixel, ray)) || !ok(c.project(ray, back))) return HUGE_VAL;
      worst = std::max(worst, static_cast<double>((back - pixel).norm()));
    }
  }
  return worst;
}

void expect_jacobian(const PinholeCamera<double>& c, const Vector3<double>& p) {
  constexpr double kStep = 1e-6;
  Vector2<double> pixel;
  Matrix<double, 2, 3> jacobian;
  ASSERT_TRUE(ok(c.project(p, pixel, jacobian)));
  for (int i = 0; i < 3; ++i) {
    Vector3<double> after = p, before = p;
    after[i] += kStep;
    before[i] -= kStep;
    Vector2<double> a, b;
    ASSERT_TRUE(ok(c.project(after, a)) && ok(c.project(before, b)));
    const Vector2<double> slope = (a - b) / (2.0 * kStep);
    EXPECT_NEAR((slope - jacobian.col(i)).norm(), 0.0, 1e-5 * c.fx)
        << p.x() << ' ' << p.y() << ' ' << p.z() << ' ' << i;
  }
}

// Calibrations of real lenses, rounded: TUM-VI (cropped), RealSense T265 (cropped), an action
// camera.
const PinholeCamera<double> kFisheyes[] = {
    fisheye(344, 344, 190.98, 0.0034824, 0.000715, -0.0020532, 0.00020294),
    fisheye(600, 440, 286.3, -0.0083, 0.0478, -0.0458, 0.0081),
    fisheye(640, 480, 300.0, 0.0, 0.0, 0.0, 0.0),
    fisheye(640, 480, 420.0, -0.05, 0.02, -0.03, 0.01)};

// Azure Kinect's colour and infrared cameras, and a phone's wide lens.
const PinholeCamera<double> kRationals[] = {
    rational(304.0, 0.52, -2.69, 6e-4, -2e-4, 1.53, 0.40, -2.51, 1.46),
    rational(315.0, 5.29, 3.42, -9e-5, 9e-5, 0.19, 5.62, 5.06, 1.08),
    rational(400.0, -0.1, 0.05, 1e-3, -1e-3, 0.0, 0.02, 0.0, 0.0)};

TEST(FisheyeLens, IsThetaOfTheAngleWithTheAxis) {
  const PinholeCamera<double>& c = kFisheyes[0];
  for (const double angle : {1e-9, 1e-3, 0.0099, 0.0101, 0.3, 0.9, 1.2, 1.39}) {
    for (const double turn : {0.0, 0.7, 2.0, -2.5}) {
      const double s = angle * angle;
      const double d = angle * (1.0 + s * (c.k1 + s * (c.k2 + s * (c.k3 + s * c.k4))));
      const Vector3<double> p(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                              std::cos(angle));
      Vector2<double> pixel;
      ASSERT_TRUE(ok(c.project(p, pixel))) << angle;
      EXPECT_NEAR(pixel.x(), c.cx + c.fx * d * std::cos(turn), 1e-9) << angle;
      EXPECT_NEAR(pixel.y(), c.cy + c.fy * d * std::sin(turn), 1e-9) << angle;
      expect_jacobian(c, 2.0 * p);
    }
  }
}

TEST(FisheyeLens, EveryPixelHasItsRay) {
  for (const PinholeCamera<double>& c : kFisheyes) {
    ASSERT_TRUE(ok(c.validate())) << c.k1;
    EXPECT_TRUE(c.has_distortion());
    EXPECT_LT(largest_return_px(c, 3), 1e-3) << c.k1;
    const PinholeCamera<float> rounded = cast<float>(c);
    ASSERT_TRUE(ok(rounded.validate())) << c.k1;
    EXPECT_LT(largest_return_px(rounded, 3), 0.05) << c.k1;
  }
}

TEST(FisheyeLens, EndsAtTheWidestRay) {
  const PinholeCamera<double> whole =
      fisheye(512, 512, 190.98, 0.0034824, 0.000715, -0.0020532, 2e-4);
  EXPECT_EQ(whole.validate(), Status::kBadConfig);
  Vector3<double> ray;
  EXPECT_EQ(whole.unproject({0.0, 0.0}, ray), Status::kOutOfView);
  EXPECT_TRUE(ray.allFinite());
  EXPECT_TRUE(ok(whole.unproject({0.0, 256.0}, ray)));
  Vector2<double> pixel(1.0, 2.0);
  EXPECT_EQ(whole.project({5.8, 0.0, 1.0}, pixel), Status::kOutOfView);
  EXPECT_EQ(pixel, Vector2<double>(1.0, 2.0));
  EXPECT_TRUE(ok(whole.project({5.6, 0.0, 1.0}, pixel)));
}

TEST(FisheyeLens, AFoldIsNoLens) {
  // Slope 1 - 1.5 theta^2: it ends at 0.816 rad.
  const PinholeCamera<double> folded = fisheye(640, 480, 300.0, -0.5, 0.0, 0.0, 0.0);
  EXPECT_EQ(folded.validate(), Status::kBadConfig);
  EXPECT_EQ(cast<float>(folded).validate(), Status::kBadConfig);
  Vector2<double> pixel;
  EXPECT_TRUE(ok(folded.project({std::tan(0.81), 0.0, 1.0}, pixel)));
  EXPECT_EQ(folded.project({std::tan(0.82), 0.0, 1.0}, pixel), Status::kOutOfView);
  EXPECT_TRUE(ok(fisheye(640, 480, 900.0, -0.5, 0.0, 0.0, 0.0).validate()));
}

TEST(FisheyeLens, OtherCoefficientsAndLensesAreRefused) {
  for (double PinholeCamera<double>::*member :
       {&PinholeCamera<double>::p1, &PinholeCamera<double>::p2, &PinholeCamera<double>::k5,
        &PinholeCamera<double>::k6}) {
    PinholeCamera<double> c = kFisheyes[0];
    c.*member = 1e-3;
    EXPECT_EQ(c.validate(), Status::kBadConfig);
  }
  PinholeCamera<double> c = kFisheyes[0];
  c.k4 = std::nan("");
  EXPECT_EQ(c.validate(), Status::kBadConfig);
  c = kFisheyes[0];
  c.lens = static_cast<Lens>(7);
  EXPECT_EQ(c.validate(), Status::kBadConfig);
}

TEST(RationalLens, IsTheQuotientAndItsTangentialPart) {
  for (const PinholeCamera<double>& c : kRationals) {
    EXPECT_TRUE(c.is_rational());
    for (const Vector3<double>& p :
         {Vector3<double>(0.2, -0.1, 1.0), Vector3<double>(-0.9, 0.6, 2.0),
          Vector3<double>(0.5, 0.55, 1.0)}) {
      const double x = p.x() / p.z(), y = p.y() / p.z(), s = x * x + y * y;
      const double radial =
          (1.0 + s * (c.k1 + s * (c.k2 + s * c.k3))) / (1.0 + s * (c.k4 + s * (c.k5 + s * c.k6)));
      Vector2<double> pixel;
      ASSERT_TRUE(ok(c.project(p, pixel)));
      EXPECT_NEAR(pixel.x(), c.cx + c.fx * (x * radial + 2 * c.p1 * x * y + c.p2 * (s + 2 * x * x)),
                  1e-9);
      EXPECT_NEAR(pixel.y(), c.cy + c.fy * (y * radial + c.p1 * (s + 2 * y * y) + 2 * c.p2 * x * y),
                  1e-9);
      expect_jacobian(c, p);
    }
  }
}

TEST(RationalLens, EveryPixelHasItsRay) {
  for (const PinholeCamera<double>& c : kRationals) {
    ASSERT_TRUE(ok(c.validate())) << c.k1;
    EXPECT_LT(largest_return_px(c, 3), 1e-3) << c.k1;
    const PinholeCamera<float> rounded = cast<float>(c);
    ASSERT_TRUE(ok(rounded.validate())) << c.k1;
    EXPECT_LT(largest_return_px(rounded, 3), 0.05) << c.k1;
  }
}

TEST(RationalLens, ValidationKnowsTheFoldAndThePole) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> focal(250.0, 700.0), k(-1.5, 1.5);
  int accepted = 0;
  constexpr int kLenses = 2000;
  for (int i = 0; i < kLenses; ++i) {
    const double f = focal(random);
    const double drawn[] = {k(random), k(random), k(random), k(random), k(random), k(random)};
    const PinholeCamera<double> c =
        rational(f, drawn[0], drawn[1], 0.0, 0.0, drawn[2], drawn[3], drawn[4], drawn[5]);
    // The radius at which d first stops rising or its denominator is 0, by small steps.
    const double corner = std::hypot(std::max(c.cx, c.width - 1 - c.cx) / c.fx,
                                     std::max(c.cy, c.height - 1 - c.cy) / c.fy);
    double largest = 0.0;
    double enlarged = 0.0;  // at the corner
    bool ends = false;
    for (double r = 2e-4;
         r < PinholeCamera<double>::kWidestFisheyeRay && !ends && largest < 1.01 * corner;
         r += 2e-4) {
      const double s = r * r;
      const double m = 1.0 + s * (c.k4 + s * (c.k5 + s * c.k6));
      const double d = r * (1.0 + s * (c.k1 + s * (c.k2 + s * c.k3))) / m;
      ends = !(m > 0.0) || !(d > largest);
      if (ends) continue;
      if (largest < corner) enlarged = d / r * (d - largest) / 2e-4;
      largest = d;
    }
    if (std::abs(largest / corner - 1.0) < 2e-3) continue;  // at the corner
    if (enlarged > 0.5 * PinholeCamera<double>::kMostEnlarged) continue;
    const bool good = ok(c.validate());
    EXPECT_EQ(good, largest > corner) << c.k1 << ' ' << c.k2 << ' ' << c.k3 << " / " << c.k4 << ' '
                                      << c.k5 << ' ' << c.k6 << ' ' << largest / corner;
    accepted += good ? 1 : 0;
    if (good) {
      EXPECT_LT(largest_return_px(c, 61), 1e-3);
    }
  }
  EXPECT_GT(accepted, kLenses / 10);
  EXPECT_LT(accepted, kLenses * 9 / 10);
}

/// A picture that ends just before the lens's pole, and a coefficient that no lens has.
TEST(RationalLens, NoLensEnlargesTheBorderAHundredTimes) {
  PinholeCamera<double> c =
      rational(141.0, 0.254, -0.198, -0.0196, 0.0125, -0.0434, -0.327, 0.1452, -0.08356);
  c.cx = 190.0;
  c.cy = 119.0;
  c.width = 320;
  c.height = 240;
  EXPECT_TRUE(ok(c.validate()));
  c.height = 3894;
  EXPECT_EQ(c.validate(), Status::kBadConfig);
  EXPECT_EQ(cast<float>(c).validate(), Status::kBadConfig);
  EXPECT_EQ(rational(300.0, -0.4, 9.4e7, 0.0, 0.0, 0.06, 0.25, 0.0, 0.0).validate(),
            Status::kBadConfig);
}

TEST(RationalLens, EveryPixelHasItsRayWithTangentialTermsToo) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> focal(250.0, 700.0), k(-0.4, 0.4), p(-0.02, 0.02);
  int accepted = 0;
  constexpr int kLenses = 1000;
  for (int i = 0; i < kLenses; ++i) {
    const double f = focal(random);
    const double drawn[] = {k(random), k(random), k(random), k(random), k(random), k(random)};
    const double p1 = p(random), p2 = p(random);
    const PinholeCamera<double> c =
        rational(f, drawn[0], drawn[1], p1, p2, drawn[2], drawn[3], drawn[4], drawn[5]);
    if (!ok(c.validate())) continue;
    ++accepted;
    EXPECT_LT(largest_return_px(c, 31), 0.06)
        << f << ' ' << c.k1 << ' ' << c.k2 << ' ' << p1 << ' ' << p2 << ' ' << c.k3 << " / " << c.k4
        << ' ' << c.k5 << ' ' << c.k6;
  }
  EXPECT_GT(accepted, kLenses / 3);
}

TEST(RationalLens, PixelsFarOutsideTheImageGiveAFiniteRay) {
  for (const PinholeCamera<double>& c :
       {kRationals[0], kRationals[1], kRationals[2], kFisheyes[0], kFisheyes[1]}) {
    for (const double u : {-1e9, -3000.0, 5000.0, 1e9}) {
      EXPECT_TRUE(c.unproject({u, 0.5 * u}).allFinite()) << c.k1 << ' ' << u;
      EXPECT_TRUE(cast<float>(c).unproject({static_cast<float>(u), 0.0F}).allFinite());
    }
  }
}

}  // namespace
}  // namespace cairn
