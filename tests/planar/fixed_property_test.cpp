// The filter without floating point under any input, and under the same input for ever.
#include <memory>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "cairn/planar/fixed/fixed_ekf_slam.hpp"

#include "any_fixed.hpp"
#include "fixed_drive.hpp"

namespace cairn {
namespace {

using planar_test::any;
using planar_test::any_covariance;

/// One call with arbitrary arguments; refusals are as good as any other answer.
template <class Filter>
void step(Filter& filter) {
  FixedUpdateReport report;
  const auto id = *rc::gen::inRange<LandmarkId>(0, 7);
  switch (*rc::gen::inRange(0, 7)) {
    case 0: {
      FixedPoseCovariance covariance;
      covariance.position = any_covariance();
      covariance.heading = any<FixedVariance>();
      const FixedPose pose = {any<FixedCoordinate>(), any<FixedCoordinate>(), any<FixedAngle>()};
      (void)filter.initialise(pose, covariance);
      return;
    }
    case 1: {
      FixedIncrement increment;
      increment.distance = any<FixedOffset>();
      increment.turn = any<FixedAngle>();
      increment.distance_variance = any<FixedVariance>();
      increment.turn_variance = any<FixedVariance>();
      if (*rc::gen::arbitrary<bool>()) increment.model = IncrementModel::kExactArc;
      (void)filter.predict(increment);
      return;
    }
    case 2: {
      const FixedPointObservation seen = {id, any<FixedLength>(), any<FixedLength>(),
                                          any_covariance()};
      (void)filter.update_points({&seen, 1}, report);
      return;
    }
    case 3: {
      const FixedRangeBearingObservation seen = {id, any<FixedLength>(), any<FixedAngle>(),
                                                 any<FixedLength>(), any<FixedAngle>()};
      (void)filter.update_range_bearing({&seen, 1}, any<FixedLength>(), report);
      return;
    }
    case 4:
    case 5:
      (void)filter.add_landmark(id, any<FixedLength>(), any<FixedLength>(), any_covariance());
      return;
    default:
      (void)filter.widen_pose(any<FixedVariance>(), any<FixedVariance>());
      return;
  }
}

template <class Filter>
bool stays_sound() {
  return rc::check([] {
    const auto filter = std::make_unique<Filter>();
    FixedPoseCovariance known;
    RC_ASSERT(ok(filter->initialise({}, known)));
    for (int k = 0; k < 40; ++k) step(*filter);
    FixedPose pose;
    FixedPoseCovariance covariance;
    filter->pose(pose, covariance);
    RC_ASSERT(pose.heading <= kFixedPi && pose.heading > -kFixedPi);
    RC_ASSERT(covariance.heading.raw() >= 0);
    for (int slot = 0; slot < filter->landmark_count(); ++slot) {
      FixedRangeBearingPrediction prediction;
      (void)filter->predict_range_bearing(slot, {}, FixedLength::nearest(0.1),
                                          FixedAngle::nearest(0.1), prediction);
      (void)filter->landmark(slot);
    }
  });
}

TEST(FixedFilterProperty, StaysSoundUnderAnyInput) {
  EXPECT_TRUE(stays_sound<FixedGroupSlam<4>>());
}

TEST(FixedFilterProperty, StaysSoundUnderAnyInputAsEkf) {
  EXPECT_TRUE(stays_sound<FixedEkfSlam<4>>());
}

/// What is measured for ever sinks far below what is never measured.
TEST(FixedFilterProperty, StaysSoundInManyUpdatesOfOnePlace) {
  constexpr int kUpdates = 100000;
  planar_test::FixedDrive<4> drive(1, 1e9, 0.0);
  const std::array<std::pair<LandmarkId, Vector2<double>>, 3> landmarks = {
      {{1, {6.0, -3.0}}, {2, {5.0, -1.0}}, {3, {2.0, 1.0}}}};
  for (const auto& [id, position] : landmarks) drive.see_point(id, position);
  for (int k = 0; k < kUpdates; ++k) {
    drive.move(0.0, 0.0, IncrementModel::kEuler);
    drive.see_ranges(landmarks, 0.0);
    if (k % 1000 != 999) continue;
    ASSERT_TRUE(drive.good()) << k;
    ASSERT_LT(drive.mean_difference(), 1e-3) << k;
    ASSERT_LT(drive.covariance_difference(), 1e-3) << k;
  }
  EXPECT_EQ(drive.fixed().saturations(), 0U);
}

}  // namespace
}  // namespace cairn
