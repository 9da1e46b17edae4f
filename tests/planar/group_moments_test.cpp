// Moments of a point that turns with an uncertain heading, in single precision.
#include "cairn/planar/error_model/group_moments.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace cairn::detail {
namespace {

/// As they are written down: right in double precision alone.
TurnedPointMoments<double> written_down(double s2, const double* m, const double* c,
                                        const double* xi) {
  const double rho = std::exp(-0.5 * s2);
  const double along = 0.5 * std::pow(std::expm1(-s2), 2);
  const double across = -0.5 * std::expm1(-2.0 * s2);
  const double jm[2] = {-m[1], m[0]};
  TurnedPointMoments<double> out;
  out.mean[0] = rho * m[0];
  out.mean[1] = rho * m[1];
  out.cov[0] = along * m[0] * m[0] + across * jm[0] * jm[0] + 2.0 * rho * jm[0] * c[0] + xi[0];
  out.cov[1] =
      along * m[0] * m[1] + across * jm[0] * jm[1] + rho * (jm[0] * c[1] + jm[1] * c[0]) + xi[1];
  out.cov[2] = along * m[1] * m[1] + across * jm[1] * jm[1] + 2.0 * rho * jm[1] * c[1] + xi[2];
  out.with_heading[0] = rho * s2 * jm[0] + c[0];
  out.with_heading[1] = rho * s2 * jm[1] + c[1];
  return out;
}

TEST(GroupMoments, AreThoseInDoublePrecisionForEveryHeadingVariance) {
  const float m[2] = {3.0F, -7.0F};
  const double m_double[2] = {3.0, -7.0};
  for (float s2 = 1e-12F; s2 < 1e3F; s2 *= 1.7F) {
    // A third of the covariance that is possible, of either sign.
    const float xi[3] = {4.0F * s2, -1.0F * s2, 9.0F * s2};
    const float c[2] = {0.66F * s2, -1.0F * s2};
    const double xi_double[3] = {4.0 * s2, -1.0 * s2, 9.0 * s2};
    const double c_double[2] = {double{c[0]}, double{c[1]}};
    const auto got = turned_point_moments(s2, m, c, xi);
    const auto expected = written_down(s2, m_double, c_double, xi_double);
    for (int i = 0; i < 3; ++i) {
      EXPECT_NEAR(got.cov[i], expected.cov[i], 4e-6 * (expected.cov[0] + expected.cov[2])) << s2;
    }
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(got.with_heading[i], expected.with_heading[i], 2e-6 * s2 * 7.0) << s2;
      EXPECT_NEAR(got.mean[i], expected.mean[i], 1e-6 * 7.0) << s2;
    }
  }
}

/// A vehicle that turned where it stands: the heading alone is uncertain, and what the error is
/// written in cancels.
TEST(GroupMoments, HaveNoNegativeVarianceWherePartsCancel) {
  for (float s2 = 1e-14F; s2 < 1e4F; s2 *= 1.3F) {
    for (int k = 0; k < 40; ++k) {
      const float angle = 0.16F * static_cast<float>(k);
      const float reach = 0.01F + static_cast<float>(k * k);
      const float m[2] = {reach * std::cos(angle), reach * std::sin(angle)};
      const float c[2] = {m[1] * s2, -m[0] * s2};
      const float xi[3] = {c[0] * m[1], -c[0] * m[0], -c[1] * m[0]};
      const auto got = turned_point_moments(s2, m, c, xi);
      const double a = got.cov[0], b = got.cov[1], d = got.cov[2];
      ASSERT_GE(a, 0.0) << s2 << " " << k;
      ASSERT_GE(d, 0.0) << s2 << " " << k;
      ASSERT_LE(b * b, a * d * (1.0 + 1e-5)) << s2 << " " << k;
    }
  }
}

TEST(GroupMoments, OfAHeadingThatIsKnownButForADenormal) {
  const float m[2] = {0.0114931976F, -0.0359539166F};
  const float c[2] = {-7.6651026e-43F, -2.45227231e-43F};
  const float xi[3] = {1.97131822e-9F, -6.71524214e-9F, 2.28752928e-8F};
  const auto got = turned_point_moments(2.23535131e-41F, m, c, xi);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(got.cov[i], xi[i], 1e-6F * xi[2]) << i;
}

/// Found by the fuzzer: a start that is known, then some noise of odometry.
TEST(GroupMoments, OfAHeadingThatIsKnownToATenthOfAMilliradian) {
  const float m[2] = {-0.0723760873F, -0.100168243F};
  const float c[2] = {-1.82476934e-9F, 1.28942701e-9F};
  const float xi[3] = {9.20879414e-11F, -6.50716148e-11F, 4.5981205e-11F};
  const auto got = turned_point_moments(3.61587311e-8F, m, c, xi);
  EXPECT_GT(got.cov[0], 0.0F);
  EXPECT_GT(got.cov[2], 0.0F);
}

}  // namespace
}  // namespace cairn::detail
