#include <utility>

#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/fixed/fixed_ekf_slam.hpp"

#include "fixed_drive.hpp"

namespace cairn {
namespace {

using Drive = planar_test::FixedDriveOf<FixedEkfSlam<16>, EkfSlam<double, 16>>;
using Landmark = std::pair<LandmarkId, Vector2<double>>;

constexpr double kSameMean = 1e-4;        // m, rad
constexpr double kSameCovariance = 1e-4;  // of the deviations

std::array<Landmark, 12> ring() {
  std::array<Landmark, 12> landmarks;
  for (int i = 0; i < 12; ++i) {
    const double angle = 0.5 * i;
    landmarks[static_cast<std::size_t>(i)] = {
        static_cast<LandmarkId>(i + 1),
        Vector2<double>(3.0 + (6.0 + 0.3 * i) * std::cos(angle), 2.0 + 6.0 * std::sin(angle))};
  }
  return landmarks;
}

void expect_equal(const Drive& drive) {
  ASSERT_TRUE(drive.good());
  EXPECT_LT(drive.mean_difference(), kSameMean);
  EXPECT_LT(drive.covariance_difference(), kSameCovariance);
}

TEST(FixedEkf, EqualsDoubleWithPointsOfCorrelatedNoise) {
  Drive drive(1);
  const auto landmarks = ring();
  for (int k = 0; k < 240; ++k) {
    drive.move(0.1, 0.03, IncrementModel::kEuler);
    if (k % 3 == 2) drive.move(0.05, -0.01, IncrementModel::kExactArc);
    expect_equal(drive);
    const auto& [id, position] = landmarks[static_cast<std::size_t>(k % 12)];
    drive.see_point(id, position);
    if (k % 20 == 19) expect_equal(drive);
  }
  EXPECT_EQ(drive.fixed().landmark_count(), 12);
  EXPECT_EQ(drive.fixed().saturations(), 0U);
}

TEST(FixedEkf, EqualsDoubleWithRangesAndBearings) {
  Drive drive(2);
  const auto landmarks = ring();
  for (const auto& [id, position] : landmarks) drive.see_point(id, position);
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
      EXPECT_NEAR(fixed.range_variance.to_double(), expected.covariance(0, 0), 1e-6);
      EXPECT_NEAR(fixed.range_bearing.to_double(), expected.covariance(0, 1), 1e-6);
      EXPECT_NEAR(fixed.bearing_variance.to_double(), expected.covariance(1, 1), 1e-6);
    }
    drive.see_ranges(landmarks, 0.3);
  }
  expect_equal(drive);
  EXPECT_EQ(drive.fixed().saturations(), 0U);
}

TEST(FixedEkf, EqualsDoubleWhereLandmarksComeAndGo) {
  Drive drive(3);
  const auto landmarks = ring();
  for (int k = 0; k < 300; ++k) {
    drive.move(0.1, 0.04, IncrementModel::kEuler);
    const auto& [id, position] = landmarks[static_cast<std::size_t>(5 * k % 12)];
    drive.see_point(id, position);
    if (k % 7 != 6) continue;
    const LandmarkId gone = landmarks[static_cast<std::size_t>(k % 12)].first;
    const int slot = drive.fixed().find(gone);
    if (slot < 0) continue;
    ASSERT_TRUE(ok(drive.fixed().remove_landmark(slot)));
    ASSERT_TRUE(ok(drive.reference().remove_landmark(drive.reference().find(gone))));
  }
  expect_equal(drive);
}

TEST(FixedEkf, RestsWhereDoubleRests) {
  Drive drive(4, 13.82);
  const auto landmarks = ring();
  for (const auto& [id, position] : landmarks) drive.see_point(id, position);
  for (int k = 0; k < 60; ++k) {
    const bool rests = k % 20 > 8;
    drive.move(rests ? 0.0 : 0.1, rests ? 0.0 : 0.02, IncrementModel::kEuler);
    drive.see_ranges(landmarks, 0.0);
    ASSERT_TRUE(drive.good()) << k;
  }
  expect_equal(drive);
}

TEST(FixedEkf, WidensAfterLastingRefusalsAsDouble) {
  Drive drive(5, 13.82);
  const auto landmarks = ring();
  for (const auto& [id, position] : landmarks) drive.see_point(id, position);
  for (int k = 0; k < 60; ++k) {
    drive.move(0.1, 0.02, IncrementModel::kEuler);
    drive.see_ranges(landmarks, 0.0, k > 5 ? 0.4 : 0.0);
  }
  ASSERT_TRUE(drive.good());
  EXPECT_EQ(drive.fixed().health().reacquisitions, drive.reference().health().reacquisitions);
  expect_equal(drive);
}

}  // namespace
}  // namespace cairn
