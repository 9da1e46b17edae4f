#include <cmath>

#include <gtest/gtest.h>

#include "planar_filter_fixture.hpp"

// Observation models are open: a type with an id, a sensor with check() and linearise(), and
// PlanarSlam::update() takes them. The two models below live in this file alone.

namespace cairn {
namespace {

/// A landmark seen in bearing alone (rad, positive to the left): one row.
struct BearingObservation {
  LandmarkId id = kNoLandmark;
  double bearing = 0.0;
  double sigma = 0.0;
};
struct BearingSensor {
  Status check(const BearingObservation& o) const {
    if (!is_finite(o.bearing)) return Status::kNonFiniteInput;
    return o.sigma > 0.0 ? Status::kOk : Status::kInvalidArgument;
  }
  template <int Dim>
  bool linearise(const BearingObservation& o, const RelativeFrame<double>& frame,
                 const double* relative, const RelativeCovariance<double>&,
                 LinearisedObservation<double, Dim>& out) const {
    double body[2];
    frame.to_body(relative, body);
    const double squared = body[0] * body[0] + body[1] * body[1];
    if (!(squared > 0.01)) return false;
    out.rows = 1;
    out.innovation[0] = wrap_angle(o.bearing - std::atan2(body[1], body[0]));
    out.h[0][0] = -body[1] / squared;
    out.h[0][1] = body[0] / squared;
    frame.row_to_relative(out.h[0][0], out.h[0][1]);
    out.r00 = o.sigma * o.sigma;
    return true;
  }
};

/// A point in the vehicle frame with one standard deviation: PointSensor in other words, its rows
/// written out.
struct RoundPoint {
  LandmarkId id = kNoLandmark;
  Vector2<double> y = Vector2<double>::Zero();
  double sigma_m = 0.0;
};
struct RoundPointSensor {
  Status check(const RoundPoint&) const { return Status::kOk; }
  template <int Dim>
  bool linearise(const RoundPoint& o, const RelativeFrame<double>& frame, const double* relative,
                 const RelativeCovariance<double>&, LinearisedObservation<double, Dim>& out) const {
    double body[2];
    frame.to_body(relative, body);
    for (int r = 0; r < 2; ++r) {
      out.innovation[r] = o.y(r) - body[r];
      out.h[r][r] = 1.0;
      frame.row_to_relative(out.h[r][0], out.h[r][1]);
    }
    out.r00 = o.sigma_m * o.sigma_m;
    out.r11 = out.r00;
    return true;
  }
};

template <class Filter>
class ObservationModel : public planar_test::PlanarFilter<Filter> {
 protected:
  void SetUp() override {
    planar_test::PlanarFilter<Filter>::SetUp();
    this->run(0, 300);
  }
  BearingObservation bearing_of(int slot, double off_rad, double sigma) const {
    const Vector2<double> body = this->expected(slot);
    return {this->filter_.landmark_id(slot), std::atan2(body.y(), body.x()) + off_rad, sigma};
  }
  static std::uint64_t hash_of(const Filter& filter) {
    Hash64 hash;
    filter.hash(hash);
    return hash.value();
  }
};
TYPED_TEST_SUITE(ObservationModel, planar_test::Filters, );

TYPED_TEST(ObservationModel, OneRowCountsAsOneMeasurement) {
  UpdateReport report;
  const BearingObservation seen[2] = {this->bearing_of(0, 0.001, 0.01),
                                      this->bearing_of(1, -0.002, 0.01)};
  ASSERT_TRUE(ok(this->filter_.update(Span<BearingObservation>(seen, 2), BearingSensor{}, report)));
  EXPECT_EQ(report.matches, 2);
  EXPECT_EQ(report.nis_dof, 2);
  EXPECT_EQ(this->filter_.landmark_statistics(0).rejected_in_row, 0U);
}

/// A bearing alone does what range and bearing do when the range says nothing.
TYPED_TEST(ObservationModel, ABearingEqualsRangeAndBearingWithoutRange) {
  TypeParam other = this->filter_;
  const BearingObservation seen = this->bearing_of(0, 0.01, 0.02);
  RangeBearingObservation<double> both;
  both.id = seen.id;
  both.range = this->expected(0).norm();
  both.bearing = seen.bearing;
  both.sigma_range = 1e5;
  both.sigma_bearing = seen.sigma;
  UpdateReport report;
  ASSERT_TRUE(
      ok(this->filter_.update(Span<BearingObservation>(&seen, 1), BearingSensor{}, report)));
  ASSERT_TRUE(ok(other.update_range_bearing({&both, 1}, 0.0, report)));
  EXPECT_LT((this->filter_.pose().position - other.pose().position).norm(), 1e-8);
  EXPECT_LT((this->filter_.pose_covariance() - other.pose_covariance()).cwiseAbs().maxCoeff(),
            1e-8);
  EXPECT_LT((this->filter_.landmark_covariance(0) - other.landmark_covariance(0)).norm(), 1e-8);
}

/// Two rows written out give what the product's own points give.
TYPED_TEST(ObservationModel, TwoRowsEqualThePointsOfTheProduct) {
  TypeParam other = this->filter_;
  RoundPoint mine;
  PointObservation<double> point;
  mine.id = point.id = this->filter_.landmark_id(2);
  mine.y = point.y = this->expected(2) + Vector2<double>(0.08, -0.05);
  mine.sigma_m = 0.1;
  point.R = 0.01 * Matrix2<double>::Identity();
  UpdateReport report;
  UpdateReport reference;
  ASSERT_TRUE(ok(this->filter_.update(Span<RoundPoint>(&mine, 1), RoundPointSensor{}, report)));
  ASSERT_TRUE(ok(other.update_points({&point, 1}, reference)));
  EXPECT_EQ(report.nis_dof, 2);
  EXPECT_NEAR(report.nis, reference.nis, 1e-6);
  EXPECT_LT((this->filter_.pose().position - other.pose().position).norm(), 1e-12);
  EXPECT_LT((this->filter_.pose_covariance() - other.pose_covariance()).cwiseAbs().maxCoeff(),
            1e-12);
}

TYPED_TEST(ObservationModel, UnknownLandmarksArePassedOverAndGrossErrorsGated) {
  const std::uint64_t before = this->hash_of(this->filter_);
  BearingObservation seen[2] = {this->bearing_of(0, 1.5, 0.001), this->bearing_of(1, 0.0, 0.01)};
  seen[1].id = 9999;
  UpdateReport report;
  ASSERT_TRUE(ok(this->filter_.update(Span<BearingObservation>(seen, 2), BearingSensor{}, report)));
  EXPECT_EQ(report.matches, 1);
  EXPECT_EQ(report.gated, 1);
  EXPECT_EQ(report.nis_dof, 0);
  EXPECT_EQ(this->hash_of(this->filter_), before);
}

/// check() refuses for all: nothing of the call is used.
TYPED_TEST(ObservationModel, ARefusedObservationLeavesTheStateEqualToTheBit) {
  const std::uint64_t before = this->hash_of(this->filter_);
  BearingObservation seen[2] = {this->bearing_of(0, 0.01, 0.01), this->bearing_of(1, 0.01, 0.0)};
  UpdateReport report;
  const Span<BearingObservation> both(seen, 2);
  EXPECT_EQ(this->filter_.update(both, BearingSensor{}, report), Status::kInvalidArgument);
  seen[1].bearing = std::nan("");
  EXPECT_EQ(this->filter_.update(both, BearingSensor{}, report), Status::kNonFiniteInput);
  EXPECT_EQ(this->filter_.health().non_finite_inputs, 1U);
  EXPECT_EQ(this->hash_of(this->filter_), before);
}

}  // namespace
}  // namespace cairn
