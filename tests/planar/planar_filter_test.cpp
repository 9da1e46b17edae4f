#include <limits>

#include <gtest/gtest.h>

#include "planar_filter_fixture.hpp"

namespace cairn {
namespace {

using planar_test::Drive;
using planar_test::feed;
using planar_test::make_drive;
using planar_test::PlanarFilter;
using planar_test::Sighting;
using planar_test::start;
using planar_test::Step;
using planar_test::WorldSettings;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class Filter>
std::uint64_t hash_of(const Filter& filter) {
  Hash64 hash;
  filter.hash(hash);
  return hash.value();
}

TYPED_TEST_SUITE(PlanarFilter, planar_test::Filters, );

TYPED_TEST(PlanarFilter, AddsUpdatesAndRemovesLandmarks) {
  this->run(0, 300);
  auto& filter = this->filter_;
  const int count = filter.landmark_count();
  ASSERT_GT(count, 4);
  const LandmarkId last = filter.landmark_id(count - 1);
  const Vector2<double> last_position = filter.landmark_position(count - 1);
  const Matrix2<double> last_covariance = filter.landmark_covariance(count - 1);
  const LandmarkId gone = filter.landmark_id(1);

  ASSERT_EQ(filter.remove_landmark(1), Status::kOk);
  EXPECT_EQ(filter.find(gone), -1);
  EXPECT_EQ(filter.find(last), 1);
  EXPECT_EQ(filter.landmark_count(), count - 1);
  EXPECT_TRUE(filter.landmark_position(1).isApprox(last_position, 0.0));
  EXPECT_TRUE(filter.landmark_covariance(1).isApprox(last_covariance, 0.0));
  EXPECT_EQ(filter.remove_landmark(count), Status::kNotFound);
  EXPECT_EQ(filter.remove_landmark(-1), Status::kNotFound);

  const double before = filter.landmark_covariance(1).trace();
  UpdateReport report;
  ASSERT_EQ(this->see(last, this->expected(1) + Vector2<double>(0.05, -0.03), report), Status::kOk);
  EXPECT_EQ(report.matches, 1);
  EXPECT_EQ(report.nis_dof, 2);
  EXPECT_GT(report.nis, 0.0);
  EXPECT_LT(filter.landmark_covariance(1).trace(), before);
  EXPECT_EQ(filter.health().landmarks_removed, 1U);

  // Its id can be added again, as a new landmark.
  ASSERT_EQ(filter.add_landmark(gone, {2.0, 1.0}, 0.01 * Matrix2<double>::Identity()), Status::kOk);
  EXPECT_EQ(filter.find(gone), count - 1);
  this->run(300, 600);
}

TYPED_TEST(PlanarFilter, SlipsLaterallyAcrossItsHeadingAlone) {
  this->run(0, 40);
  auto& filter = this->filter_;
  const Matrix3<double> before = filter.pose_covariance();
  const auto pose = filter.mean_pose();
  ASSERT_EQ(filter.slip_laterally(0.04), Status::kOk);
  const Matrix2<double> R = planar_test::rotation(pose.heading);
  const Matrix2<double> grown =
      R.transpose() * (filter.pose_covariance() - before).topLeftCorner(2, 2) * R;
  EXPECT_NEAR(grown(1, 1), 0.04, 1e-3);
  EXPECT_NEAR(grown(0, 0), 0.0, 1e-3);
  EXPECT_NEAR(grown(0, 1), 0.0, 1e-3);
  EXPECT_NEAR(filter.pose_covariance()(2, 2), before(2, 2), 1e-9);
  EXPECT_EQ(filter.slip_laterally(-0.01), Status::kInvalidArgument);
  EXPECT_EQ(filter.slip_laterally(kNan), Status::kNonFiniteInput);
  EXPECT_EQ(TypeParam().slip_laterally(0.01), Status::kNotInitialised);
}

/// Removing a landmark is marginalising: the rest of the filter does as if nothing had been.
TYPED_TEST(PlanarFilter, RemovalLeavesTheOthersAlone) {
  this->run(0, 300);
  auto& filter = this->filter_;
  TypeParam other = filter;
  const auto pose = filter.pose();
  const Matrix3<double> covariance = filter.pose_covariance();
  ASSERT_TRUE(ok(filter.remove_landmark(0)));
  EXPECT_EQ(filter.pose().position, pose.position);
  EXPECT_TRUE(filter.pose_covariance().isApprox(covariance, 0.0));
  // An update of a landmark that both still have moves both alike.
  const LandmarkId id = filter.landmark_id(2);
  PointObservation<double> o;
  o.id = id;
  o.y = this->expected(2) + Vector2<double>(0.1, 0.05);
  o.R = 0.01 * Matrix2<double>::Identity();
  UpdateReport report;
  ASSERT_TRUE(ok(filter.update_points({&o, 1}, report)));
  ASSERT_TRUE(ok(other.update_points({&o, 1}, report)));
  EXPECT_LT((filter.pose().position - other.pose().position).norm(), 1e-12);
  EXPECT_LT((filter.pose_covariance() - other.pose_covariance()).cwiseAbs().maxCoeff(), 1e-12);
}

TYPED_TEST(PlanarFilter, ReplacesTheLandmarkUnusedLongest) {
  auto& filter = this->filter_;
  const Matrix2<double> noise = 0.01 * Matrix2<double>::Identity();
  for (LandmarkId id = 1; id <= 20; ++id) {
    const double angle = 0.3 * id;
    ASSERT_TRUE(ok(filter.add_landmark(id, {3 * std::cos(angle), 3 * std::sin(angle)}, noise)));
  }
  EXPECT_EQ(filter.add_landmark(7, {1, 1}, noise), Status::kDuplicate);
  EXPECT_EQ(filter.add_landmark(99, {1, 1}, noise), Status::kFull);
  EXPECT_EQ(filter.health().landmarks_refused, 1U);
  // All but number 13 are seen again and again.
  UpdateReport report;
  for (int k = 0; k < 20; ++k) {
    std::vector<PointObservation<double>> seen;
    for (LandmarkId id = 1; id <= 20; ++id) {
      if (id == 13) continue;
      PointObservation<double> o;
      o.id = id;
      o.y = this->expected(filter.find(id));
      o.R = noise;
      seen.push_back(o);
    }
    ASSERT_TRUE(ok(filter.update_points({seen.data(), static_cast<int>(seen.size())}, report)));
    EXPECT_EQ(report.nis_dof, 38);
  }
  LandmarkId replaced = 0;
  ASSERT_EQ(filter.add_landmark(99, {1, 1}, noise, &replaced), Status::kOk);
  EXPECT_EQ(replaced, 13U);
  EXPECT_EQ(filter.find(13), -1);
  EXPECT_EQ(filter.landmark_count(), 20);
  EXPECT_EQ(filter.health().landmarks_replaced, 1U);
  const int slot = filter.find(99);
  ASSERT_GE(slot, 0);
  EXPECT_LT((this->expected(slot) - Vector2<double>(1, 1)).norm(), 1e-12);
  EXPECT_EQ(this->see(99, {1.01, 0.99}, report), Status::kOk);
  EXPECT_EQ(report.nis_dof, 2);
}

TYPED_TEST(PlanarFilter, GatesGrossErrors) {
  this->run(0, 300);
  const std::uint64_t before = hash_of(this->filter_);
  UpdateReport report;
  const Vector2<double> y = this->expected(0) + Vector2<double>(2.0, -2.0);
  ASSERT_EQ(this->see(this->filter_.landmark_id(0), y, report), Status::kOk);
  EXPECT_EQ(report.gated, 1);
  EXPECT_EQ(report.nis_dof, 0);
  EXPECT_EQ(hash_of(this->filter_), before);
  EXPECT_EQ(this->filter_.landmark_statistics(0).rejected_in_row, 1U);
}

TYPED_TEST(PlanarFilter, ErrorsLeaveTheStateEqualToTheBit) {
  this->run(0, 103);
  auto& filter = this->filter_;
  const std::uint64_t before = hash_of(filter);
  UpdateReport report;
  const LandmarkId id = filter.landmark_id(0);

  PlanarIncrement<double> increment;
  increment.distance_m = kNan;
  EXPECT_EQ(filter.predict(increment), Status::kNonFiniteInput);
  increment.distance_m = 0.1;
  increment.covariance << 1e-4, 2e-4, 2e-4, 1e-4;
  EXPECT_EQ(filter.predict(increment), Status::kInvalidArgument);
  EXPECT_EQ(filter.predict(ackermann_increment(0.5, 1.55, 0.1, 0.5, 0.05, 0.03)),
            Status::kInvalidArgument);

  EXPECT_EQ(this->see(id, {kNan, 1.0}, report), Status::kNonFiniteInput);
  PointObservation<double> points[2];
  points[0].id = id;
  points[0].y = this->expected(0);
  points[1] = points[0];
  points[1].R << 1, 2, 2, 1;
  EXPECT_EQ(filter.update_points({points, 2}, report), Status::kInvalidArgument);
  EXPECT_EQ(filter.update_points({points, TypeParam::kMaxObservations + 1}, report),
            Status::kInvalidArgument);

  RangeBearingObservation<double> range;
  range.id = id;
  range.range = 3.0;
  range.sigma_range = 0.1;
  range.sigma_bearing = 0.0;
  EXPECT_EQ(filter.update_range_bearing({&range, 1}, 0.0, report), Status::kInvalidArgument);
  range.sigma_bearing = std::numeric_limits<double>::infinity();
  EXPECT_EQ(filter.update_range_bearing({&range, 1}, 0.0, report), Status::kNonFiniteInput);

  EXPECT_EQ(filter.add_landmark(500, {kNan, 0.0}, Matrix2<double>::Identity()),
            Status::kNonFiniteInput);
  EXPECT_EQ(filter.add_landmark(500, {1.0, 0.0}, Matrix2<double>::Zero()),
            Status::kInvalidArgument);
  EXPECT_EQ(filter.add_landmark(kNoLandmark, {1.0, 0.0}, Matrix2<double>::Identity()),
            Status::kInvalidArgument);
  EXPECT_EQ(filter.add_landmark(id, {1.0, 0.0}, Matrix2<double>::Identity()), Status::kDuplicate);

  PlanarPose<double> pose;
  Matrix3<double> covariance = Matrix3<double>::Identity();
  covariance(0, 1) = 2.0;
  covariance(1, 0) = 2.0;
  EXPECT_EQ(filter.initialise(pose, covariance), Status::kInvalidArgument);
  pose.heading = kNan;
  EXPECT_EQ(filter.initialise(pose, Matrix3<double>::Identity()), Status::kNonFiniteInput);
  PlanarParameters<double> parameters;
  parameters.gate = -1.0;
  EXPECT_EQ(filter.initialise(PlanarPose<double>{}, Matrix3<double>::Identity(), parameters),
            Status::kBadConfig);

  EXPECT_EQ(hash_of(filter), before);
  EXPECT_GT(filter.health().non_finite_inputs, 0U);

  TypeParam fresh;
  EXPECT_EQ(fresh.predict(PlanarIncrement<double>{}), Status::kNotInitialised);
  EXPECT_EQ(fresh.update_points({points, 1}, report), Status::kNotInitialised);
  EXPECT_EQ(fresh.add_landmark(1, {1.0, 0.0}, Matrix2<double>::Identity()),
            Status::kNotInitialised);
}

TYPED_TEST(PlanarFilter, InterleavedInstancesGiveTheSameBytes) {
  TypeParam alone;
  TypeParam first;
  TypeParam second;
  const Drive other = make_drive(4);
  ASSERT_TRUE(ok(start(alone, this->drive_)));
  ASSERT_TRUE(ok(start(first, this->drive_)));
  ASSERT_TRUE(ok(start(second, other)));
  for (int k = 0; k < 200; ++k) feed(alone, this->drive_, this->drive_.steps[k]);
  for (int k = 0; k < 200; ++k) {
    feed(first, this->drive_, this->drive_.steps[k]);
    feed(second, other, other.steps[k]);
  }
  EXPECT_EQ(hash_of(alone), hash_of(first));
  EXPECT_NE(hash_of(alone), hash_of(second));
}

/// Range and bearing with the sensor ahead of the centre: the estimate stays with the truth.
TYPED_TEST(PlanarFilter, RangeAndBearingHoldTheVehicle) {
  WorldSettings s;
  s.position_variance = 1e-4;
  s.heading_variance = 1e-5;
  const Drive d = make_drive(9, s);
  auto& filter = this->filter_;
  ASSERT_TRUE(ok(start(filter, d)));
  const double offset = 0.3;
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal(0.0, 1.0);
  double nis = 0;
  int dof = 0;
  for (const Step& step : d.steps) {
    ASSERT_TRUE(ok(filter.predict(d.increment(step))));
    std::vector<RangeBearingObservation<double>> seen;
    for (const Sighting& sighting : step.sightings) {
      const Eigen::Vector2d body = planar_test::rotation(step.truth(2)).transpose() *
                                       (d.landmarks[sighting.id - 1] - step.truth.head<2>()) -
                                   Eigen::Vector2d(offset, 0.0);
      RangeBearingObservation<double> o;
      o.id = sighting.id;
      o.sigma_range = 0.05;
      o.sigma_bearing = 0.02;
      o.range = std::max(0.01, body.norm() + o.sigma_range * normal(generator));
      o.bearing = std::atan2(body.y(), body.x()) + o.sigma_bearing * normal(generator);
      seen.push_back(o);
    }
    UpdateReport report;
    ASSERT_TRUE(ok(
        filter.update_range_bearing({seen.data(), static_cast<int>(seen.size())}, offset, report)));
    nis += report.nis;
    dof += report.nis_dof;
    for (const auto& o : seen) {
      if (filter.find(o.id) >= 0) continue;
      const Eigen::Vector2d along(std::cos(o.bearing), std::sin(o.bearing));
      const Eigen::Vector2d across(-along.y(), along.x());
      const Vector2<double> y = Eigen::Vector2d(offset, 0.0) + o.range * along;
      Matrix2<double> noise = o.sigma_range * o.sigma_range * along * along.transpose() +
                              std::pow(o.range * o.sigma_bearing, 2) * across * across.transpose();
      noise(1, 0) = noise(0, 1);
      ASSERT_TRUE(ok(filter.add_landmark(o.id, y, noise)));
    }
  }
  EXPECT_LT((filter.pose().position - d.steps.back().truth.head<2>()).norm(), 0.3);
  EXPECT_NEAR(nis / dof, 1.0, 0.1);
  EXPECT_LT(filter.health().innovations_gated, 20U);
}

/// Either misprint put back: the lifted filter is lost.
TEST(LiftedIekfSlam, MisprintsAreFatal) {
  WorldSettings s;
  s.position_variance = 1e-4;
  s.heading_variance = 1e-5;
  const Drive d = make_drive(3, s);
  const auto rmse = [&](unsigned misprints) {
    LiftedIekfSlam<double, 20> filter;
    LiftedParameters lifted;
    lifted.misprints = misprints;
    EXPECT_TRUE(ok(start(filter, d, planar_test::ungated<double>(), lifted)));
    double square = 0;
    for (const Step& step : d.steps) {
      feed(filter, d, step);
      square += (filter.pose().position - step.truth.head<2>()).squaredNorm();
    }
    return std::sqrt(square / static_cast<double>(d.steps.size()));
  };
  const double correct = rmse(0U);
  EXPECT_LT(correct, 0.3);
  EXPECT_GT(rmse(kMisprint18Row6), 10.0 * correct);
  EXPECT_GT(rmse(kMisprint26Row5), 3.0 * correct);
  EXPECT_GT(rmse(kMisprint18Row6 | kMisprint26Row5), 10.0 * correct);
}

}  // namespace
}  // namespace cairn
