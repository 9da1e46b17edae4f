#include "cairn/window/epipolar_motion.hpp"

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

constexpr int kPoints = 60;
constexpr double kSigma = 0.0015;

/// A cloud of points, 0.5 to 4 away, as two cameras see it.
template <class T>
struct TwoViews {
  DirectionPair<T> pairs[kPoints];
  T rho[kPoints];

  /// `wrong`: so many pairs, from the first, do not belong together.
  TwoViews(std::uint64_t seed, const Rigid<T>& motion, int wrong = 0) {
    Random random(seed);
    const auto within = [&](double low, double high) {
      return static_cast<T>(low + (high - low) * 1e-6 * random.below(1000000));
    };
    for (int i = 0; i < kPoints;) {
      const T z = within(0.5, 4.0);
      const Vector3<T> p{z * within(-0.55, 0.55), z * within(-0.4, 0.4), z};
      const Vector3<T> q = motion * p;
      if (q.z() < T(0.1)) continue;
      const auto noise = [&] { return within(-0.5 * kSigma, 0.5 * kSigma); };
      pairs[i].first = Vector2<T>{p.x() / p.z() + noise(), p.y() / p.z() + noise()};
      pairs[i].second = Vector2<T>{q.x() / q.z() + noise(), q.y() / q.z() + noise()};
      if (i < wrong) pairs[i].second += Vector2<T>{within(-0.06, 0.06), within(-0.06, 0.06)};
      rho[i++] = T(1) / z;
    }
  }
};

template <class T>
Rigid<T> motion_of(const Vector3<T>& turn, const Vector3<T>& translation) {
  Rigid<T> motion;
  motion.rotation = rotation_exp(turn);
  motion.translation = translation;
  return motion;
}

template <class T>
T turn_between(const Rigid<T>& a, const Rigid<T>& b) {
  return sqrt(rotation_log(Quaternion<T>(a.rotation.conjugate() * b.rotation)).squaredNorm());
}

/// Sine of the angle between translations; 2 where they point opposite ways.
template <class T>
T direction_error(const Rigid<T>& a, const Rigid<T>& b) {
  if (a.translation.dot(b.translation) <= T(0)) return T(2);
  return sqrt(a.translation.cross(b.translation).squaredNorm() /
              (a.translation.squaredNorm() * b.translation.squaredNorm()));
}

const Vector3<double> kTranslations[] = {{0.2, 0, 0},     {0, -0.2, 0.02},   {0, 0, 0.3},
                                         {0, 0, -0.3},    {-0.15, 0.1, 0.2}, {0.05, 0.02, -0.3},
                                         {-0.2, 0.1, 0.1}};

/// Share of the trials, over directions and turns, in which the motion is found.
template <class T>
double share_found(int wrong) {
  std::uint64_t seed = 0;
  int found_count = 0;
  for (int round = 0; round < 4; ++round) {
    for (const Vector3<double>& translation : kTranslations) {
      for (const double turn : {0.0, 0.1, -0.25}) {
        const Rigid<T> truth = motion_of(Vector3<T>(T(0.3 * turn), T(turn), T(-0.2 * turn)),
                                         Vector3<T>(translation.cast<T>()));
        const TwoViews<T> views(++seed, truth, wrong);
        EpipolarOptions<T> options;
        options.sigma = static_cast<T>(kSigma);
        Rigid<T> found;
        T cost = T(0);
        if (!estimate_epipolar_motion(views.pairs, kPoints, options, found, cost)) continue;
        EXPECT_NEAR(static_cast<double>(found.translation.squaredNorm()), 1.0, 1e-5);
        found_count +=
            turn_between(found, truth) < T(0.02) && direction_error(found, truth) < T(0.1);
      }
    }
  }
  return found_count / static_cast<double>(seed);
}

TEST(EpipolarMotion, FindsEveryDirection) {
  EXPECT_GT(share_found<double>(0), 0.98);
  EXPECT_GT(share_found<float>(0), 0.98);
}

TEST(EpipolarMotion, FindsNearlyAllWithOneMatchInTenWrong) {
  EXPECT_GT(share_found<double>(6), 0.9);
  EXPECT_GT(share_found<float>(6), 0.9);
}

TEST(EpipolarMotion, AWrongBeliefCostsMore) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Rigid<double> truth = motion_of<double>({0.02, -0.04, 0.0}, {0.02, 0.0, -0.25});
    const TwoViews<double> views(seed, truth);
    const EpipolarOptions<double> options;
    // Forward, taken for sideways with a turn that keeps the middle in its place.
    Rigid<double> wrong = motion_of<double>({0.0, 0.2, 0.0}, {-0.3, 0.0, 0.0});
    Rigid<double> right = truth;
    const double cost = improve_epipolar_motion(views.pairs, kPoints, options, right);
    EXPECT_GT(improve_epipolar_motion(views.pairs, kPoints, options, wrong), 2.0 * cost + 10.0);
    Rigid<double> found;
    double least = 0.0;
    ASSERT_TRUE(estimate_epipolar_motion(views.pairs, kPoints, options, found, least));
    EXPECT_LT(direction_error(found, truth), 0.1);
    EXPECT_LT(least, 1.01 * cost + 0.1);
  }
}

TEST(EpipolarMotion, NoSingleMismatchCountsMoreThanAnother) {
  const Rigid<double> truth = motion_of<double>({0.02, -0.04, 0.0}, {0.2, 0.05, -0.1});
  const EpipolarOptions<double> options;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    TwoViews<double> views(seed, truth);
    Rigid<double> right = truth;
    const double cost = improve_epipolar_motion(views.pairs, kPoints, options, right);
    double before = 0.0;
    for (const double off : {0.1, 0.4}) {
      // Across its epipolar line, by some 60 and 250 sigmas.
      views.pairs[5].second.y() += off;
      right = truth;
      EpipolarOptions<double> still = options;
      still.believed_iterations = 0;
      const double with = improve_epipolar_motion(views.pairs, kPoints, still, right);
      EXPECT_LT(with, cost + options.mismatch_cost + 3.0) << seed;
      if (before > 0.0) {
        EXPECT_NEAR(with, before, 1e-9) << seed;
      }
      before = with;
    }
  }
}

TEST(EpipolarMotion, DepthsFollow) {
  const Rigid<double> truth = motion_of<double>({0.01, 0.05, 0.0}, {0.25, 0.05, 0.1});
  const TwoViews<double> views(3, truth);
  for (int i = 0; i < kPoints; ++i) {
    EXPECT_NEAR(triangulate_inverse_depth(views.pairs[i], truth), views.rho[i], 0.03) << i;
  }
  EXPECT_EQ(triangulate_inverse_depth(views.pairs[0], Rigid<double>()), 0.0);
}

TEST(EpipolarMotion, RefusesTooFewPairs) {
  const TwoViews<float> views(1, motion_of<float>({0, 0, 0}, {0.2F, 0, 0}));
  Rigid<float> motion = motion_of<float>({0, 0, 0}, {7, 0, 0});
  float cost = -3.0F;
  EXPECT_FALSE(estimate_epipolar_motion(views.pairs, 7, EpipolarOptions<float>(), motion, cost));
  EXPECT_EQ(motion.translation.x(), 7.0F);
  EXPECT_EQ(cost, -3.0F);
}

TEST(EpipolarMotion, AStandingCameraAndEqualPairsAreFinite) {
  DirectionPair<float> pairs[kPoints];
  for (DirectionPair<float>& pair : pairs) pair = {Vector2<float>(0.1F, 0.2F), {0.1F, 0.2F}};
  Rigid<float> motion;
  float cost = 0.0F;
  if (estimate_epipolar_motion(pairs, kPoints, EpipolarOptions<float>(), motion, cost)) {
    EXPECT_TRUE(is_finite(cost));
    EXPECT_TRUE(is_finite(motion.translation.squaredNorm()));
  }
  const TwoViews<float> standing(5, Rigid<float>());
  if (estimate_epipolar_motion(standing.pairs, kPoints, EpipolarOptions<float>(), motion, cost)) {
    EXPECT_TRUE(is_finite(cost));
    EXPECT_LT(turn_between(motion, Rigid<float>()), 0.02F);
  }
}

}  // namespace
}  // namespace cairn
