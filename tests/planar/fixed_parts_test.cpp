#include <cmath>

#include <gtest/gtest.h>

#include "cairn/planar/fixed/consensus.hpp"
#include "cairn/planar/fixed/correction.hpp"
#include "cairn/planar/fixed/error.hpp"
#include "cairn/planar/fixed/map_frame.hpp"
#include "cairn/planar/fixed/pixel_model.hpp"
#include "cairn/planar/fixed/state.hpp"
#include "cairn/planar/fixed/update_records.hpp"

namespace cairn::detail {
namespace {

using State = FixedPlanarState<6, 3>;
using Errors = FixedPlanarError<State, FixedError::kGroup>;
using Correction = FixedCorrection<State, FixedError::kGroup>;
using Rows = FixedStateRow[3];

constexpr double kExact = 1e-6;

FixedCoordinate metres(double value) {
  return FixedCoordinate::nearest(value);
}
FixedVariance variance(double value) {
  return FixedVariance::nearest(value);
}
FixedCholesky3 own_noise(double sigma_m) {
  FixedCholesky3 noise;
  FixedCovariance3 covariance;
  covariance.xx = covariance.yy = covariance.zz = variance(sigma_m * sigma_m);
  std::uint32_t none = 0;
  EXPECT_TRUE(cholesky(covariance, noise, none));
  return noise;
}

/// GIVEN a vehicle at (2, 1), heading along y, and landmarks 1 to 3 about it.
class FixedParts : public testing::Test {
 protected:
  explicit FixedParts(bool tilts = false) {
    FixedPose pose;
    pose.x = metres(2.0);
    pose.y = metres(1.0);
    pose.heading = FixedAngle::nearest(1.5707963267948966);
    state_.start(pose, tilts);
    FixedPoseCovariance covariance;
    covariance.position = {variance(0.04), {}, variance(0.09)};
    covariance.heading = variance(0.0025);
    const FixedCovariance2 tilt = {variance(1e-4), {}, variance(4e-4)};
    errors_.start(covariance, tilts ? &tilt : nullptr, saturations_);
    for (int k = 0; k < 3; ++k) {
      const FixedLength beside[3] = {FixedLength::nearest(4.0 + k), FixedLength::nearest(1.0 - k),
                                     FixedLength::nearest(0.5 * k)};
      Rows rows;
      state_.place_beside_vehicle(state_.rotation(), beside, rows, saturations_);
      errors_.append(rows, own_noise(0.1), 2, saturations_);
      state_.enter(static_cast<LandmarkId>(k + 1), 0);
    }
  }
  ~FixedParts() override { EXPECT_EQ(saturations_, 0U); }

  FixedIncrement ahead(double distance_m) const {
    FixedIncrement increment;
    increment.distance = FixedOffset::nearest(distance_m);
    increment.distance_variance = variance(0.01);
    increment.turn_variance = variance(1e-4);
    return increment;
  }
  void drive(double distance_m) {
    const FixedIncrement increment = ahead(distance_m);
    const FixedStep step = fixed_step(increment, state_.heading(), saturations_);
    errors_.propagate(increment, step, saturations_);
    state_.move(step, increment.turn, saturations_);
  }

  State state_;
  Errors errors_;
  Correction correction_;
  std::uint32_t saturations_ = 0;
};

TEST_F(FixedParts, StateKeepsWhereThingsAreWhateverTheAnchor) {
  const double x = state_.in_world(state_.landmark_at(0, 0), 0).to_double();
  EXPECT_NEAR(x, 1.0, kExact);  // 1 m to the left of a vehicle that heads along y
  EXPECT_NEAR(state_.relative(0, 1).to_double(), 4.0, kExact);
  drive(3.0);
  state_.recentre(saturations_);
  EXPECT_EQ(state_.vehicle_at(1), FixedCoordinate());
  EXPECT_NEAR(state_.pose().y.to_double(), 4.0, kExact);
  EXPECT_NEAR(state_.in_world(state_.landmark_at(0, 0), 0).to_double(), x, kExact);
}

/// The last landmark takes the slot, and the states behind move up: as RowScaledFactor's rows do.
TEST_F(FixedParts, StateAndErrorsAgreeWhereALandmarkLiesAfterOneLeft) {
  const FixedVariance before = errors_.covariance(state_.state_of(2), state_.state_of(1));
  errors_.remove(state_.state_of(0));
  state_.remove(0);
  ASSERT_EQ(state_.count(), 2);
  const int second = state_.find(2);
  const int third = state_.find(3);
  EXPECT_EQ(third, 0);
  EXPECT_NEAR(state_.relative(third, 1).to_double(), 6.0, kExact);
  EXPECT_EQ(state_.next_state(), errors_.factor().size());
  EXPECT_NEAR(errors_.covariance(state_.state_of(third), state_.state_of(second)).to_double(),
              before.to_double(), kExact);
}

TEST_F(FixedParts, ErrorsAddTheNoiseOfColumns) {
  const int states[2] = {1, state_.state_of(1)};
  const double was = errors_.covariance(states[0], states[1]).to_double();
  const std::int64_t columns[2][2] = {{std::int64_t{1} << 39, std::int64_t{1} << 38},
                                      {0, std::int64_t{1} << 40}};
  errors_.add_noise(columns, states, 40, saturations_);
  EXPECT_NEAR(errors_.covariance(states[0], states[1]).to_double(), was + 0.5 * 0.25, kExact);
  EXPECT_NEAR(errors_.covariance(1, 1).to_double(), 0.25, kExact);  // shared pose errors are apart
}

TEST_F(FixedParts, ErrorsStayTheSameWhenTheFactorTakesInTheMotion) {
  drive(0.5);
  const double relative = errors_.relative_covariance(state_, 1, saturations_).yy.to_double();
  const FixedPoseCovariance pose = errors_.pose_covariance(state_, saturations_);
  EXPECT_NEAR(relative, 0.02, 0.002);
  errors_.absorb_motion(state_, saturations_);
  EXPECT_TRUE(errors_.motion().empty());
  EXPECT_NEAR(errors_.relative_covariance(state_, 1, saturations_).yy.to_double(), relative,
              kExact);
  const FixedPoseCovariance after = errors_.pose_covariance(state_, saturations_);
  EXPECT_NEAR(after.position.xx.to_double(), pose.position.xx.to_double(), kExact);
  EXPECT_NEAR(after.heading.to_double(), pose.heading.to_double(), kExact);
}

TEST_F(FixedParts, ErrorsRelativeToTheVehicleDoNotSeeItsAnchor) {
  drive(0.5);
  errors_.absorb_motion(state_, saturations_);
  const double before = errors_.relative_covariance(state_, 2, saturations_).xx.to_double();
  errors_.recentre(state_, saturations_);
  state_.recentre(saturations_);
  EXPECT_NEAR(errors_.relative_covariance(state_, 2, saturations_).xx.to_double(), before, kExact);
}

/// P' = P - P h^T h P / (h P h^T + sigma^2), and P h^T (h P h^T + sigma^2)^-1 of the innovation.
TEST_F(FixedParts, CorrectionIsThatOfAKalmanUpdate) {
  drive(0.5);
  errors_.absorb_motion(state_, saturations_);
  FixedSighting seen;
  seen.slot = 1;
  seen.sine = FixedRatio::nearest(1.0);
  seen.innovation[0] = FixedOffset::nearest(0.2);
  seen.sigma[0] = seen.sigma[1] = FixedOffset::nearest(0.05);
  const int l = state_.state_of(1) + 1;
  const auto p = [&](int i, int j) { return errors_.covariance(i, j).to_double(); };
  const double s = p(l, l) - 2.0 * p(l, 2) + p(2, 2) + 0.05 * 0.05;
  const double by_vehicle = p(l, 2) - p(2, 2);
  const double left = p(2, 2) - by_vehicle * by_vehicle / s;
  correction_.clear(errors_.factor().size());
  const std::int64_t nis = correction_.take_in(seen, 0, state_, errors_, saturations_);
  EXPECT_NEAR(FixedCoordinate::from_raw(nis).to_double(), 0.2 * 0.2 / s, 1e-4);
  EXPECT_NEAR(FixedOffset::from_raw(correction_[2]).to_double(), by_vehicle / s * 0.2, kExact);
  EXPECT_NEAR(p(2, 2), left, kExact);
  correction_[0] = 0;  // no turn: the rest of the correction is a shift
  const double y = state_.pose().y.to_double();
  correction_.apply(state_, saturations_);
  EXPECT_NEAR(state_.pose().y.to_double() - y, by_vehicle / s * 0.2, kExact);
}

/// Camera 1 m above the vehicle's origin, along its x axis.
FixedMount camera_ahead() {
  FixedMount mount;
  mount.w = mount.y = FixedRatio::nearest(0.5);
  mount.x = mount.z = FixedRatio::nearest(-0.5);
  mount.origin[2] = FixedLength::nearest(1.0);
  return mount;
}

class FixedPixelParts : public FixedParts {
 protected:
  FixedPixelParts() : FixedParts(true) {
    camera_.fx = camera_.fy = FixedPixel::nearest(400.0);
    camera_.cx = FixedPixel::nearest(320.0);
    camera_.cy = FixedPixel::nearest(240.0);
    camera_.width = 640;
    camera_.height = 480;
  }
  FixedPixelModel<State, Errors> model() {
    return {state_, errors_, state_.camera_view(camera_, mount_, saturations_),
            FixedPixel::nearest(0.5)};
  }

  FixedCamera camera_;
  FixedMount mount_ = camera_ahead();
};

/// Landmark k lies at (4 + k, 1 - k, k / 2): 1 - k to the left of the camera, which is 1 m high.
TEST_F(FixedPixelParts, ModelExpectsThePixelsOfAPinhole) {
  for (int k = 0; k < 3; ++k) {
    FixedPixelPrediction expected;
    ASSERT_TRUE(model().expect(k, expected, errors_.scratch(), saturations_));
    EXPECT_NEAR(expected.pixel[0].to_double(), 320.0 - 400.0 * (1.0 - k) / (4.0 + k), 0.01);
    EXPECT_NEAR(expected.pixel[1].to_double(), 240.0 + 400.0 * (1.0 - 0.5 * k) / (4.0 + k), 0.01);
    // Of the landmark's own 0.1 m across, and half a pixel.
    const double across = 400.0 * 0.1 / (4.0 + k);
    EXPECT_GT(expected.xx.to_double(), across * across);
  }
}

TEST_F(FixedPixelParts, ConsensusCountsThoseThatOneOfThemExplains) {
  FixedPixelSighting sightings[3];
  FixedPixelMatch matches[3];
  for (int k = 0; k < 3; ++k) {
    FixedPixelRows rows;
    ASSERT_TRUE(model().sight(k, sightings[k], rows, errors_.scratch(), saturations_));
    sightings[k].source = k;
    // All by the same turn of the body, the last by another one.
    matches[k].pixel[0] = rows.pixel[0];
    matches[k].pixel[1] =
        add(rows.pixel[1], FixedPixel::nearest(k == 2 ? -60.0 : 2.0), saturations_);
    sightings[k].difference(matches[k].pixel, rows.pixel, sightings[k].innovation, saturations_);
    sightings[k].own =
        errors_.innovation_covariance(state_, sightings[k], errors_.scratch(), saturations_);
  }
  const FixedConsensus<State, FixedError::kGroup> consensus(camera_, mount_,
                                                            FixedScore::nearest(5.99));
  bool inliers[3] = {};
  EXPECT_EQ(consensus.count(0, sightings, 3, matches, state_, errors_, correction_, inliers,
                            saturations_),
            2);
  EXPECT_TRUE(inliers[0] && inliers[1] && !inliers[2]);
  EXPECT_NEAR(state_.pose().y.to_double(), 1.0, kExact) << "the state stays";
}

TEST_F(FixedParts, MapFrameHoldsItsPositionsAtZeroAndOne) {
  const FixedMapFrame<State> frame(state_, 0, 2);
  FixedLength lambda[2];
  ASSERT_TRUE(
      frame.place(state_.landmark_at(0, 0), state_.landmark_at(0, 1), lambda, saturations_));
  EXPECT_NEAR(lambda[0].to_double(), 0.0, kExact);
  ASSERT_TRUE(
      frame.place(state_.landmark_at(2, 0), state_.landmark_at(2, 1), lambda, saturations_));
  EXPECT_NEAR(lambda[0].to_double(), 1.0, kExact);
  EXPECT_NEAR(lambda[1].to_double(), 0.0, kExact);
  Rows rows;
  frame.landmark_rows(lambda, rows);
  const int ahead = state_.state_of(2);
  EXPECT_NEAR(errors_.covariance_of(rows).xx.to_double(),
              errors_.covariance(ahead, ahead).to_double(), kExact)
      << "as sure as the position that it lies at";
  EXPECT_FALSE(FixedMapFrame<State>(state_, 1, 1)
                   .place(state_.vehicle_at(0), state_.vehicle_at(1), lambda, saturations_));
}

TEST(FixedTilt, ForgetsWithTimeAndKeepsItsVariance) {
  FixedTiltParameters parameters;
  parameters.sigma_pitch = FixedAngle::nearest(0.01);
  parameters.sigma_roll = FixedAngle::nearest(0.02);
  std::uint32_t saturations = 0;
  const FixedTiltStep step = tilt_step(parameters, FixedOffset::nearest(0.5), saturations);
  const double left = step.left.to_double();
  EXPECT_NEAR(left, std::exp(-0.5), kExact);
  const double noise = std::ldexp(static_cast<double>(step.noise[1]), -FixedTiltStep::kNoiseBits);
  EXPECT_NEAR(noise * noise + left * left * 4e-4, 4e-4, 1e-9);
  EXPECT_NEAR(tilt_noise(parameters, FixedOffset::nearest(0.5)).yy.to_double(), noise * noise,
              1e-9);
  EXPECT_EQ(saturations, 0U);
}

/// A landmark that is refused again and again, while others are used, is widened from its
/// `reacquire_landmark_after`-th refusal on, by one doubling more each time.
TEST(FixedUpdateRecords, WidenALandmarkThatTheGateLocksOut) {
  LandmarkSlots<4> slots;
  for (LandmarkId id = 1; id <= 3; ++id) slots.push(id, 0);
  FixedPlanarParameters parameters;
  parameters.reacquire_landmark_after = 3;
  parameters.reacquire_steps = 1;
  FixedUpdateRecords<8> records;
  Health health;
  FixedSighting used[2];
  used[0].slot = 0;
  used[1].slot = 2;
  const int expected[6] = {-1, -1, 0, 1, -1, -1};
  for (int k = 0; k < 6; ++k) {
    FixedUpdateReport report;
    records.begin();
    records.refuse(1, report, health);
    records.finish(used, 2, parameters, slots, health);
    ASSERT_EQ(records.refused(), 1);
    EXPECT_EQ(records.refused_slot(0), 1);
    EXPECT_EQ(records.doublings(0, parameters, slots), expected[k]) << k;
    EXPECT_EQ(report.gated, 1);
  }
  EXPECT_EQ(slots.statistics(2).last_measured, records.updates());
  EXPECT_EQ(slots.statistics(1).rejected_in_row, 6U);
  EXPECT_EQ(health.innovations_used, 12U);
}

}  // namespace
}  // namespace cairn::detail
