#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/fixed/fixed_ekf_slam.hpp"

#include "fixed_drive.hpp"

namespace cairn {
namespace {

struct Group {
  using Drive = planar_test::FixedDrive<16>;
  static constexpr double kSameMean = 2e-5;        // m, rad
  static constexpr double kSameCovariance = 2e-6;  // of the deviations
};
struct Ekf {
  using Drive = planar_test::FixedDriveOf<FixedEkfSlam<16>, EkfSlam<double, 16>>;
  static constexpr double kSameMean = 1e-4;
  static constexpr double kSameCovariance = 1e-4;
};

/// GIVEN a ring of twelve landmarks, and a filter beside its like in double.
template <class Kind>
class FixedPlanarFilter : public testing::Test {
 protected:
  using Drive = typename Kind::Drive;

  const planar_test::RingLandmark& landmark(int k) const {
    return landmarks_[static_cast<std::size_t>(k % 12)];
  }
  void see_each_once(Drive& drive) const {
    for (const auto& [id, position] : landmarks_) drive.see_point(id, position);
  }
  static void expect_equal(const Drive& drive) {
    ASSERT_TRUE(drive.good());
    EXPECT_LT(drive.mean_difference(), Kind::kSameMean);
    EXPECT_LT(drive.covariance_difference(), Kind::kSameCovariance);
  }

  const std::array<planar_test::RingLandmark, 12> landmarks_ = planar_test::ring();
};

using Kinds = testing::Types<Group, Ekf>;
TYPED_TEST_SUITE(FixedPlanarFilter, Kinds);

TYPED_TEST(FixedPlanarFilter, EqualsDoubleWithPointsOfCorrelatedNoise) {
  typename TypeParam::Drive drive(1);
  for (int k = 0; k < 240; ++k) {
    drive.move(0.1, 0.03, IncrementModel::kEuler);
    if (k % 3 == 2) drive.move(0.05, -0.01, IncrementModel::kExactArc);
    this->expect_equal(drive);
    const auto& [id, position] = this->landmark(k);
    drive.see_point(id, position);
    if (k % 20 == 19) this->expect_equal(drive);
  }
  EXPECT_EQ(drive.fixed().landmark_count(), 12);
  EXPECT_EQ(drive.fixed().saturations(), 0U);
}

TYPED_TEST(FixedPlanarFilter, EqualsDoubleWithRangesAndBearings) {
  typename TypeParam::Drive drive(2);
  this->see_each_once(drive);
  for (int k = 0; k < 120; ++k) {
    drive.move(0.1, 0.05, IncrementModel::kExactArc);
    drive.move(0.05, -0.02, IncrementModel::kExactArc);
    for (int slot = 0; slot < 12; slot += 5) {
      FixedRangeBearingPrediction fixed;
      RangeBearingPrediction<double> expected;
      ASSERT_TRUE(ok(drive.fixed().predict_range_bearing(slot, FixedLength::nearest(0.3),
                                                         FixedLength::nearest(0.1),
                                                         FixedAngle::nearest(0.02), fixed)));
      ASSERT_TRUE(ok(drive.reference().predict_range_bearing(slot, 0.3, 0.1, 0.02, expected)));
      EXPECT_NEAR(fixed.range.to_double(), expected.range, TypeParam::kSameMean);
      EXPECT_NEAR(fixed.bearing.to_double(), expected.bearing, TypeParam::kSameMean);
      EXPECT_NEAR(fixed.range_variance.to_double(), expected.covariance(0, 0), 1e-6);
      EXPECT_NEAR(fixed.range_bearing.to_double(), expected.covariance(0, 1), 1e-6);
      EXPECT_NEAR(fixed.bearing_variance.to_double(), expected.covariance(1, 1), 1e-6);
    }
    drive.see_ranges(this->landmarks_, 0.3);
  }
  this->expect_equal(drive);
  EXPECT_EQ(drive.fixed().saturations(), 0U);
}

TYPED_TEST(FixedPlanarFilter, EqualsDoubleWhereLandmarksComeAndGo) {
  typename TypeParam::Drive drive(3);
  for (int k = 0; k < 300; ++k) {
    drive.move(0.1, 0.04, IncrementModel::kEuler);
    const auto& [id, position] = this->landmark(5 * k);
    drive.see_point(id, position);
    if (k % 7 != 6) continue;
    const LandmarkId gone = this->landmark(k).first;
    const int slot = drive.fixed().find(gone);
    if (slot < 0) continue;
    ASSERT_TRUE(ok(drive.fixed().remove_landmark(slot)));
    ASSERT_TRUE(ok(drive.reference().remove_landmark(drive.reference().find(gone))));
  }
  this->expect_equal(drive);
}

TYPED_TEST(FixedPlanarFilter, RestsWhereDoubleRests) {
  typename TypeParam::Drive drive(4, 13.82);
  this->see_each_once(drive);
  for (int k = 0; k < 60; ++k) {
    const bool rests = k % 20 > 8;
    drive.move(rests ? 0.0 : 0.1, rests ? 0.0 : 0.02, IncrementModel::kEuler);
    drive.see_ranges(this->landmarks_, 0.0);
    ASSERT_TRUE(drive.good()) << k;
  }
  this->expect_equal(drive);
}

TYPED_TEST(FixedPlanarFilter, WidensAfterLastingRefusalsAsDouble) {
  typename TypeParam::Drive drive(5, 13.82);
  this->see_each_once(drive);
  for (int k = 0; k < 60; ++k) {
    drive.move(0.1, 0.02, IncrementModel::kEuler);
    drive.see_ranges(this->landmarks_, 0.0, k > 5 ? 0.4 : 0.0);
  }
  ASSERT_TRUE(drive.good());
  EXPECT_GT(drive.fixed().health().reacquisitions, 0U);
  EXPECT_EQ(drive.fixed().health().reacquisitions, drive.reference().health().reacquisitions);
  this->expect_equal(drive);
}

}  // namespace
}  // namespace cairn
