#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "cairn/planar/lifted/equations.hpp"
#include "cairn/planar/lifted/trigonometric_moments.hpp"

namespace cairn {
namespace {

using detail::kLiftedLandmark;
using detail::kLiftedVehicle;

struct Pose {
  double x;
  double y;
  double heading;
};

struct Lifted {
  double z[kLiftedVehicle];
};
struct LiftedLandmark {
  double z[kLiftedLandmark];
};

Lifted lift(const Pose& p) {
  Lifted out{};
  detail::lift_vehicle(p.x, p.y, std::sin(p.heading), std::cos(p.heading), out.z);
  return out;
}
LiftedLandmark lift(const Pose& p, double x, double y) {
  LiftedLandmark out{};
  detail::lift_landmark(x, y, std::sin(p.heading), std::cos(p.heading), out.z);
  return out;
}

/// The motion itself, in plain numbers: (4) to (6), and its exact-arc counterpart.
Pose move(const Pose& p, const PlanarIncrement<double>& u) {
  const double direction =
      p.heading + (u.model == IncrementModel::kExactArc ? 0.5 * u.turn_rad : 0.0);
  return {p.x + u.distance_m * std::cos(direction), p.y + u.distance_m * std::sin(direction),
          p.heading + u.turn_rad};
}

detail::Monomials<double> monomials_of(const PlanarIncrement<double>& u) {
  return detail::monomials(displacement(u), std::sin(u.turn_rad), std::cos(u.turn_rad));
}

/// Poses, motions and points of a wide range, a few hundred.
template <class Check>
void for_all(Check&& check) {
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> place(-10, 10);
  std::uniform_real_distribution<double> angle(-3.1, 3.1);
  for (int k = 0; k < 300; ++k) {
    const Pose pose{place(generator), place(generator), angle(generator)};
    PlanarIncrement<double> u;
    u.distance_m = 0.1 * place(generator);
    u.turn_rad = angle(generator);
    u.model = k % 2 == 0 ? IncrementModel::kEuler : IncrementModel::kExactArc;
    const double x = place(generator);
    check(pose, u, x, place(generator));
  }
}

double landmark_transition_error(unsigned misprints) {
  double worst = 0;
  for_all([&](const Pose& pose, const PlanarIncrement<double>& u, double x, double y) {
    double out[kLiftedLandmark];
    detail::landmark_transition(monomials_of(u), lift(pose, x, y).z, out, misprints);
    const LiftedLandmark truth = lift(move(pose, u), x, y);
    for (int i = 0; i < kLiftedLandmark; ++i) {
      worst = std::max(worst, std::abs(out[i] - truth.z[i]));
    }
  });
  return worst;
}

double new_landmark_error(unsigned misprints) {
  double worst = 0;
  for_all([&](const Pose& pose, const PlanarIncrement<double>&, double x, double y) {
    double out[kLiftedLandmark];
    detail::new_landmark(lift(pose).z, x, y, out, misprints);
    const double s = std::sin(pose.heading);
    const double c = std::cos(pose.heading);
    const LiftedLandmark truth = lift(pose, pose.x + c * x - s * y, pose.y + s * x + c * y);
    for (int i = 0; i < kLiftedLandmark; ++i) {
      worst = std::max(worst, std::abs(out[i] - truth.z[i]));
    }
  });
  return worst;
}

TEST(LiftedEquations, VehicleTransitionIsTheLiftedMotion) {
  for_all([](const Pose& pose, const PlanarIncrement<double>& u, double, double) {
    double out[kLiftedVehicle];
    detail::vehicle_transition(monomials_of(u), lift(pose).z, out);
    const Lifted truth = lift(move(pose, u));
    for (int i = 0; i < kLiftedVehicle; ++i) EXPECT_NEAR(out[i], truth.z[i], 1e-12) << "row " << i;
  });
}

TEST(LiftedEquations, LandmarkTransitionIsTheLiftedMotion) {
  EXPECT_LT(landmark_transition_error(0), 1e-12);
  EXPECT_GT(landmark_transition_error(kMisprint18Row6), 1.0);
}

TEST(LiftedEquations, MeasurementIsTheRelativePosition) {
  for_all([](const Pose& pose, const PlanarIncrement<double>&, double x, double y) {
    double out[2];
    detail::lifted_relative(lift(pose).z, lift(pose, x, y).z, out);
    const double s = std::sin(pose.heading);
    const double c = std::cos(pose.heading);
    EXPECT_NEAR(out[0], c * (x - pose.x) + s * (y - pose.y), 1e-12);
    EXPECT_NEAR(out[1], -s * (x - pose.x) + c * (y - pose.y), 1e-12);
  });
}

TEST(LiftedEquations, NewLandmarkIsTheLiftedPoint) {
  EXPECT_LT(new_landmark_error(0), 1e-12);
  EXPECT_GT(new_landmark_error(kMisprint26Row5), 1.0);
}

TEST(LiftedEquations, NoiseJacobiansAreTheDerivativesOfTheTransition) {
  // (19): the Jacobians are those of (18) (for the vehicle: of (16)), not all of (16).
  for_all([](const Pose& pose, const PlanarIncrement<double>& u, double x, double y) {
    const auto d = displacement(u);
    const double s = std::sin(u.turn_rad);
    const double c = std::cos(u.turn_rad);
    const double h = 1e-6;
    const detail::Monomials<double> analytic[2] = {detail::monomials_by_distance(d, s, c),
                                                   detail::monomials_by_turn(d, s, c)};
    for (int k = 0; k < 2; ++k) {
      PlanarIncrement<double> up = u;
      PlanarIncrement<double> down = u;
      (k == 0 ? up.distance_m : up.turn_rad) += h;
      (k == 0 ? down.distance_m : down.turn_rad) -= h;
      double out[kLiftedVehicle];
      double out_landmark[kLiftedLandmark];
      detail::vehicle_transition(analytic[k], lift(pose).z, out);
      detail::landmark_transition(analytic[k], lift(pose, x, y).z, out_landmark, 0U);
      const Lifted a = lift(move(pose, up));
      const Lifted b = lift(move(pose, down));
      for (int i = 0; i < kLiftedVehicle; ++i) {
        EXPECT_NEAR(out[i], (a.z[i] - b.z[i]) / (2 * h), 1e-7);
      }
      const LiftedLandmark al = lift(move(pose, up), x, y);
      const LiftedLandmark bl = lift(move(pose, down), x, y);
      for (int i = 0; i < kLiftedLandmark; ++i) {
        EXPECT_NEAR(out_landmark[i], (al.z[i] - bl.z[i]) / (2 * h), 1e-7);
      }
    }
  });
}

TEST(LiftedEquations, NewLandmarkJacobianHasBothColumns) {
  // (28): G_new is 6x2, by x_new and by y_new.
  for_all([](const Pose& pose, const PlanarIncrement<double>&, double x, double y) {
    double by[2][kLiftedLandmark];
    detail::new_landmark_by_observation(lift(pose).z, by[0], by[1], 0U);
    for (int k = 0; k < 2; ++k) {
      double a[kLiftedLandmark];
      double b[kLiftedLandmark];
      const double dx = k == 0 ? 0.5 : 0.0;
      const double dy = k == 1 ? 0.5 : 0.0;
      detail::new_landmark(lift(pose).z, x + dx, y + dy, a, 0U);
      detail::new_landmark(lift(pose).z, x - dx, y - dy, b, 0U);
      for (int i = 0; i < kLiftedLandmark; ++i) EXPECT_NEAR(by[k][i], a[i] - b[i], 1e-12);
    }
  });
}

TEST(TrigonometricMoments, EqualSampledMoments) {
  using Mono = detail::TrigMonomial<double>;
  const double mean[3] = {0.7, 1.5, -2.0};
  const double L[3][3] = {{0.5, 0, 0}, {0.2, 0.3, 0}, {-0.1, 0.1, 0.4}};
  double covariance[3][3] = {};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) covariance[i][j] += L[i][k] * L[j][k];
    }
  }
  const Mono list[] = {
      Mono::sine(1),          Mono::cosine(1),     Mono::cosine(1) * Mono::sine(1),
      Mono::constant().of(1), Mono::sine(1).of(1), (Mono::cosine(1) * Mono::cosine(2)).of(2)};
  constexpr int kCount = 6;
  const detail::TrigonometricMoments<double> moments(mean, covariance);
  std::mt19937_64 generator(5);
  std::normal_distribution<double> normal(0, 1);
  double sum[kCount] = {};
  double product[kCount][kCount] = {};
  const int samples = 400000;
  for (int n = 0; n < samples; ++n) {
    const double e[3] = {normal(generator), normal(generator), normal(generator)};
    double v[3];
    for (int i = 0; i < 3; ++i) {
      v[i] = mean[i];
      for (int k = 0; k < 3; ++k) v[i] += L[i][k] * e[k];
    }
    const double f[kCount] = {
        std::sin(v[0]), std::cos(v[0]),        std::cos(v[0]) * std::sin(v[0]),
        v[1],           v[1] * std::sin(v[0]), v[2] * std::cos(v[0]) * std::cos(2 * v[0])};
    for (int i = 0; i < kCount; ++i) {
      sum[i] += f[i];
      for (int j = 0; j < kCount; ++j) product[i][j] += f[i] * f[j];
    }
  }
  for (int i = 0; i < kCount; ++i) {
    EXPECT_NEAR(moments.mean(list[i]), sum[i] / samples, 0.01);
    for (int j = 0; j < kCount; ++j) {
      EXPECT_NEAR(moments.covariance(list[i], list[j]),
                  product[i][j] / samples - sum[i] / samples * sum[j] / samples, 0.02)
          << i << " " << j;
    }
  }
}

TEST(TrigonometricMoments, SmallVariancesKeepTheirDigits) {
  using Mono = detail::TrigMonomial<float>;
  const float variance = 1e-6F;
  const float mean[3] = {0.0F, 1.0F, 0.0F};
  const float covariance[3][3] = {{variance, 0, 0}, {0, 1e-4F, 0}, {0, 0, 0}};
  const detail::TrigonometricMoments<float> moments(mean, covariance);
  EXPECT_NEAR(moments.covariance(Mono::sine(1), Mono::sine(1)) / variance, 1.0F, 1e-5F);
  EXPECT_NEAR(moments.covariance(Mono::constant().of(1), Mono::constant().of(1)) / 1e-4F, 1.0F,
              1e-5F);
}

}  // namespace
}  // namespace cairn
