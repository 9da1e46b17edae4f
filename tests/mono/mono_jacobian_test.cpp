#include <random>

#include <gtest/gtest.h>

#include "cairn/mono/models.hpp"

#include "mono_reference.hpp"

namespace cairn {
namespace {

using test::Dual;

class MonoJacobian : public ::testing::Test {
 protected:
  static constexpr double kTolerance = 1e-9;
  static constexpr int kTrials = 200;

  double uniform(double low, double high) {
    return low + (high - low) * std::uniform_real_distribution<double>(0.0, 1.0)(engine_);
  }
  Vector<double, 4> quaternion() {
    Vector<double, 4> q{1.0, uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
    return q / q.norm();
  }
  static PinholeCamera<double> camera(double focal_factor) {
    PinholeCamera<double> c;
    c.fx = 310.0 * focal_factor;
    c.fy = 305.0 * focal_factor;
    c.cx = 181.0;
    c.cy = 118.0;
    c.k1 = -0.12;
    c.k2 = 0.03;
    c.p1 = 1e-3;
    c.p2 = -2e-3;
    c.width = 360;
    c.height = 240;
    return c;
  }

  std::mt19937 engine_{11};
};

TEST_F(MonoJacobian, RotationStepAgreesWithDualNumbers) {
  for (int trial = 0; trial < kTrials; ++trial) {
    const Vector<double, 4> q = quaternion();
    const double size = trial % 4 == 0 ? 1e-3 : 3.0;
    const Vector3<double> w{uniform(-size, size), uniform(-size, size), uniform(-size, size)};
    using D = Dual<7>;
    D s[7];
    for (int i = 0; i < 4; ++i) s[i] = D::variable(q(i), i);
    for (int i = 0; i < 3; ++i) s[4 + i] = D::variable(w(i), 4 + i);
    const auto want = test::turn(s, s + 4, 0.04);
    const auto got = mono::rotation_step<double>(q, w, 0.04);
    for (int r = 0; r < 4; ++r) {
      const D& value = want[static_cast<std::size_t>(r)];
      EXPECT_NEAR(got.q(r), value.v, kTolerance);
      for (int c = 0; c < 4; ++c) EXPECT_NEAR(got.wrt_q(r, c), value.d[c], kTolerance);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(got.wrt_rate(r, c), value.d[4 + c], kTolerance);
    }
  }
}

TEST_F(MonoJacobian, RotationStepIsSmoothAtRest) {
  const Vector<double, 4> q = quaternion();
  const auto rest = mono::rotation_step<double>(q, Vector3<double>::Zero(), 0.04);
  const auto slow = mono::rotation_step<double>(q, Vector3<double>(3e-4, 0, 0), 0.04);
  EXPECT_NEAR((rest.wrt_rate - slow.wrt_rate).norm(), 0.0, 1e-6);
  EXPECT_EQ((rest.q - q).norm(), 0.0);
}

TEST_F(MonoJacobian, RotatedVectorsAgreeWithDualNumbers) {
  for (int trial = 0; trial < kTrials; ++trial) {
    const Vector<double, 4> q = quaternion();
    const Vector3<double> v{uniform(-3, 3), uniform(-3, 3), uniform(-3, 3)};
    using D = Dual<4>;
    D s[4];
    for (int i = 0; i < 4; ++i) s[i] = D::variable(q(i), i);
    for (const bool inverse : {false, true}) {
      const auto want = test::rotate<D>(s, {D(v(0)), D(v(1)), D(v(2))}, inverse);
      const Matrix3<double> rotation = mono::rotation_matrix<double>(q);
      const Vector3<double> value =
          inverse ? Vector3<double>(rotation.transpose() * v) : Vector3<double>(rotation * v);
      const auto got = inverse ? mono::unrotated_wrt_quaternion<double>(q, v)
                               : mono::rotated_wrt_quaternion<double>(q, v);
      for (int r = 0; r < 3; ++r) {
        EXPECT_NEAR(value(r), want[static_cast<std::size_t>(r)].v, kTolerance);
        for (int c = 0; c < 4; ++c) {
          EXPECT_NEAR(got(r, c), want[static_cast<std::size_t>(r)].d[c], kTolerance);
        }
      }
    }
  }
}

TEST_F(MonoJacobian, DirectionAndAnglesAgreeWithDualNumbersAndEachOther) {
  for (int trial = 0; trial < kTrials; ++trial) {
    const double theta = uniform(-1.4, 1.4);
    const double phi = uniform(-1.3, 1.3);
    using D = Dual<2>;
    const D t = D::variable(theta, 0), p = D::variable(phi, 1);
    const D want[3] = {cos(p) * sin(t), -sin(p), cos(p) * cos(t)};
    const auto got = mono::direction<double>(theta, phi);
    for (int r = 0; r < 3; ++r) {
      EXPECT_NEAR(got.m(r), want[r].v, kTolerance);
      for (int c = 0; c < 2; ++c) EXPECT_NEAR(got.wrt_angles(r, c), want[r].d[c], kTolerance);
    }
    const double length = uniform(0.3, 4.0);
    using E = Dual<3>;
    E v[3];
    for (int i = 0; i < 3; ++i) v[i] = E::variable(length * got.m(i), i);
    const E back_theta = atan2(v[0], v[2]);
    const E back_phi = atan2(-v[1], sqrt(v[0] * v[0] + v[2] * v[2]));
    const auto angles = mono::angles_of<double>(length * got.m);
    EXPECT_NEAR(angles.theta, theta, kTolerance);
    EXPECT_NEAR(angles.phi, phi, kTolerance);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(angles.wrt_v(0, c), back_theta.d[c], kTolerance);
      EXPECT_NEAR(angles.wrt_v(1, c), back_phi.d[c], kTolerance);
    }
  }
}

TEST_F(MonoJacobian, ProjectionOfARayAgreesWithDualNumbers) {
  int tried = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Vector<double, 4> q = quaternion();
    const double s = uniform(-0.1, 0.1);
    const Vector3<double> in_camera{uniform(-0.6, 0.6), uniform(-0.4, 0.4), uniform(0.6, 2.0)};
    const Vector3<double> ray = mono::rotation_matrix<double>(q) * in_camera;
    using D = Dual<8>;
    D state[4];
    std::array<D, 3> v;
    for (int i = 0; i < 4; ++i) state[i] = D::variable(q(i), i);
    for (int i = 0; i < 3; ++i) v[static_cast<std::size_t>(i)] = D::variable(ray(i), 4 + i);
    const auto want =
        test::distorted_pixel(camera(1.0), D::variable(s, 7), test::rotate<D>(state, v, true));
    mono::RayPixel<double> got;
    if (!ok(mono::project_ray<double>(camera(1.0 + s), 1.0 + s, q, ray, got))) continue;
    ++tried;
    for (int r = 0; r < 2; ++r) {
      const D& value = want[static_cast<std::size_t>(r)];
      EXPECT_NEAR(got.pixel(r), value.v, kTolerance);
      for (int c = 0; c < 4; ++c) EXPECT_NEAR(got.wrt_q(r, c), value.d[c], kTolerance);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(got.wrt_ray(r, c), value.d[4 + c], kTolerance);
      EXPECT_NEAR(got.wrt_focal(r), value.d[7], kTolerance);
    }
  }
  EXPECT_GT(tried, kTrials / 2);
}

TEST_F(MonoJacobian, RayOfAPixelInvertsTheProjection) {
  for (int trial = 0; trial < kTrials; ++trial) {
    const double s = uniform(-0.1, 0.1);
    const PinholeCamera<double> c = camera(1.0 + s);
    const Vector2<double> pixel{uniform(20, 340), uniform(20, 220)};
    mono::PixelRay<double> got;
    ASSERT_TRUE(ok(mono::pixel_ray<double>(c, 1.0 + s, pixel, got)));
    // Implicit function: 0 = h(ray, s) - pixel.
    using D = Dual<3>;
    const std::array<D, 3> ray = {D::variable(got.ray_camera.x(), 0),
                                  D::variable(got.ray_camera.y(), 1), D(1.0)};
    const auto h = test::distorted_pixel(camera(1.0), D::variable(s, 2), ray);
    Matrix2<double> forward;
    forward << h[0].d[0], h[0].d[1], h[1].d[0], h[1].d[1];
    const Matrix2<double> want = forward.inverse();
    // wrt_focal is exact where the pixel is reached exactly: allow for the undistortion's residual.
    const Vector2<double> want_focal = -(want * Vector2<double>(h[0].d[2], h[1].d[2]));
    for (int r = 0; r < 2; ++r) {
      for (int k = 0; k < 2; ++k) EXPECT_NEAR(got.wrt_pixel(r, k), want(r, k), kTolerance);
      EXPECT_NEAR(got.wrt_focal(r), want_focal(r), 1e-6);
    }
  }
}

TEST_F(MonoJacobian, NormalisationAgreesWithDualNumbers) {
  for (int trial = 0; trial < kTrials; ++trial) {
    const Vector<double, 4> q = uniform(0.5, 2.0) * quaternion();
    using D = Dual<4>;
    D s[4];
    for (int i = 0; i < 4; ++i) s[i] = D::variable(q(i), i);
    const D norm = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + s[3] * s[3]);
    const auto got = mono::normalisation_jacobian<double>(q);
    for (int r = 0; r < 4; ++r) {
      const D want = s[r] / norm;
      for (int c = 0; c < 4; ++c) EXPECT_NEAR(got(r, c), want.d[c], kTolerance);
    }
  }
}

}  // namespace
}  // namespace cairn
