#include <gtest/gtest.h>

#include "fixed_drive.hpp"

namespace cairn {
namespace {

using Drive = planar_test::FixedDrive<16>;
/// Along an axis the noise across it is below the step of its format.
TEST(FixedMotionNoise, ColumnsGiveTheCovarianceOfADriveNearlyAlongAnAxis) {
  for (int k = 0; k < 400; ++k) {
    FixedIncrement increment;
    increment.distance = FixedOffset::nearest(0.1);
    increment.distance_variance = FixedVariance::nearest(1.6e-5);
    increment.turn_variance = FixedVariance::nearest(9e-6);
    const double off = 1e-6 * std::pow(1.03, k);
    const auto heading = FixedAngle::nearest((k % 2) * 1.5707963267948966 + off);
    std::uint32_t saturations = 0;
    detail::FixedMotionNoise noise;
    noise.move(increment, detail::fixed_step(increment, heading, saturations), saturations);
    const auto c = noise.columns(saturations);
    const double unit = std::pow(0.5, detail::FixedMotionNoise::Columns::kBits);
    const auto covariance = [&](int i, int j) {
      double sum = static_cast<double>(c.along[i]) * static_cast<double>(c.along[j]);
      for (const auto& column : c.rest) {
        sum += static_cast<double>(column[i]) * static_cast<double>(column[j]);
      }
      return sum * unit * unit;
    };
    const double sine = std::sin(heading.to_double());
    const double cosine = std::cos(heading.to_double());
    ASSERT_NEAR(covariance(0, 0), 1.6e-5 * cosine * cosine, 1e-12) << off;
    ASSERT_NEAR(covariance(1, 0), 1.6e-5 * cosine * sine, 1e-12) << off;
    ASSERT_NEAR(covariance(1, 1), 1.6e-5 * sine * sine, 1e-12) << off;
    ASSERT_EQ(saturations, 0U);
  }
}

/// A road with a post on each side every 10 m, the last 14 of them in the map.
void drive_road(Drive& drive, int steps) {
  constexpr double kHeading = 0.5;  // of the start
  const Vector2<double> ahead(std::cos(kHeading), std::sin(kHeading));
  const Vector2<double> left(-ahead.y(), ahead.x());
  for (int k = 0; k < steps; ++k) {
    drive.move(2.0, 0.0, IncrementModel::kEuler);
    const int post = k / 5;
    for (int side = 0; side < 2; ++side) {
      const auto id = static_cast<LandmarkId>(2 * post + side + 1);
      const Vector2<double> at = Vector2<double>(3.0, -4.0) + (10.0 * post + 6.0) * ahead +
                                 (side == 0 ? 5.0 : -5.0) * left;
      if (drive.fixed().find(id) < 0 && drive.fixed().landmark_count() > 13) {
        const LandmarkId oldest = id - 14;
        ASSERT_TRUE(ok(drive.fixed().remove_landmark(drive.fixed().find(oldest))));
        ASSERT_TRUE(ok(drive.reference().remove_landmark(drive.reference().find(oldest))));
      }
      drive.see_point(id, at);
    }
    ASSERT_TRUE(drive.good());
  }
}

TEST(FixedFilter, EqualsDoubleWhereTheStartIsTwoKilometresAway) {
  Drive drive(8);
  drive_road(drive, 900);
  const Matrix3<double> covariance = drive.reference().pose_covariance();
  EXPECT_GT(std::sqrt(covariance(1, 1)), 100.0);
  EXPECT_LT(drive.mean_difference(), 0.05);
  EXPECT_LT(drive.covariance_difference(), 1e-3);
  EXPECT_EQ(drive.fixed().saturations(), 0U);
}

TEST(FixedFilter, CountsThatItWentTooFarAndGoesOn) {
  Drive drive(8);
  drive_road(drive, 1400);
  EXPECT_GT(drive.fixed().saturations(), 0U);
  EXPECT_EQ(drive.fixed().landmark_count(), 14);
}

std::uint64_t hash_of(const FixedGroupSlam<16>& filter) {
  Hash64 hash;
  filter.hash(hash);
  return hash.value();
}

TEST(FixedFilter, RefusesWhatItCannotUseAndStaysAsItWas) {
  FixedGroupSlam<16> unused;
  FixedUpdateReport report;
  EXPECT_EQ(unused.predict({}), Status::kNotInitialised);
  EXPECT_EQ(unused.update_points({}, report), Status::kNotInitialised);

  Drive drive(6);
  drive.see_point(1, {6.0, 2.0});
  FixedGroupSlam<16>& filter = drive.fixed();
  const std::uint64_t before = hash_of(filter);
  FixedIncrement increment;
  increment.turn_variance = FixedVariance::from_raw(-1);
  EXPECT_EQ(filter.predict(increment), Status::kInvalidArgument);
  increment.turn_variance = FixedVariance::nearest(1e-4);
  increment.distance_variance = FixedVariance::nearest(1e-4);
  increment.distance_turn = FixedVariance::nearest(1.1e-4);
  EXPECT_EQ(filter.predict(increment), Status::kInvalidArgument);
  increment.distance_turn = FixedVariance();
  increment.turn = FixedAngle::nearest(3.2);
  EXPECT_EQ(filter.predict(increment), Status::kInvalidArgument);
  FixedPointObservation point;
  point.id = 1;
  EXPECT_EQ(filter.update_points({&point, 1}, report), Status::kInvalidArgument);
  FixedRangeBearingObservation range;
  range.id = 1;
  EXPECT_EQ(filter.update_range_bearing({&range, 1}, {}, report), Status::kInvalidArgument);
  const FixedCovariance2 noise = {FixedVariance::nearest(0.01), {}, FixedVariance::nearest(0.01)};
  EXPECT_EQ(filter.add_landmark(kNoLandmark, {}, {}, noise), Status::kInvalidArgument);
  EXPECT_EQ(filter.add_landmark(1, {}, {}, noise), Status::kDuplicate);
  EXPECT_EQ(filter.add_landmark(2, {}, {}, {}), Status::kInvalidArgument);
  EXPECT_EQ(filter.remove_landmark(5), Status::kNotFound);
  EXPECT_EQ(filter.widen_pose(FixedVariance::from_raw(-1), {}), Status::kInvalidArgument);
  FixedPlanarParameters parameters;
  parameters.gate = FixedScore();
  EXPECT_EQ(filter.initialise({}, {}, parameters), Status::kBadConfig);
  EXPECT_EQ(hash_of(filter), before);
}

/// No noise, and noise far better than the map: the factor stays what it is.
TEST(FixedFilter, SurvivesExactOdometryAndExactSightings) {
  Drive drive(7);
  const auto landmarks = planar_test::ring();
  for (const auto& [id, position] : landmarks) drive.see_point(id, position);
  FixedGroupSlam<16>& filter = drive.fixed();
  FixedIncrement step;
  step.distance = FixedOffset::nearest(0.1);
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(ok(filter.predict(step)));
    FixedPointObservation point;
    point.id = 3;
    point.x = FixedLength::nearest(4.0);
    point.noise = {FixedVariance::from_raw(1), {}, FixedVariance::from_raw(1)};
    FixedUpdateReport report;
    ASSERT_TRUE(ok(filter.update_points({&point, 1}, report)));
  }
  for (int slot = 0; slot < 12; ++slot) {
    EXPECT_GE(filter.landmark(slot).covariance.xx.raw(), 0);
    EXPECT_GE(filter.landmark(slot).covariance.yy.raw(), 0);
  }
}

/// A position that the heading determines has no variance of its own: what rounding leaves of it is
/// not below 0. What does not fit is as unsure as the format says.
TEST(FixedFilter, MomentsHaveNoNegativeVariance) {
  std::uint32_t saturations = 0;
  for (int k = 1; k < 400; ++k) {
    const double x_m = -0.001 * k;
    const double variance = 1e-9 * k * k;
    FixedPoseCovariance covariance;
    covariance.heading = FixedVariance::nearest(variance);
    covariance.y_heading = FixedVariance::nearest(-x_m * variance);
    covariance.position.yy = FixedVariance::nearest(x_m * x_m * variance);
    const FixedLength x = FixedLength::nearest(x_m);
    const auto m = detail::turned_point_moments(x, FixedLength(), covariance, saturations);
    ASSERT_GE(m.covariance.position.xx.raw(), 0) << k;
    ASSERT_GE(m.covariance.position.yy.raw(), 0) << k;
    ASSERT_LT(m.covariance.position.yy.to_double(), 1e-6) << k;
  }
  EXPECT_EQ(saturations, 0U);
  FixedPoseCovariance wide;
  wide.heading = FixedVariance::nearest(3e5);
  wide.y_heading = FixedVariance::nearest(-5e5);
  const FixedLength x = FixedLength::nearest(100.0);
  const auto m = detail::turned_point_moments(x, FixedLength(), wide, saturations);
  EXPECT_GE(m.covariance.position.yy.raw(), 0);
}

}  // namespace
}  // namespace cairn
