#include <type_traits>

#include <gtest/gtest.h>

#include "planar_filter_fixture.hpp"

namespace cairn {
namespace {

using planar_test::Drive;
using planar_test::feed;
using planar_test::make_drive;
using planar_test::Sighting;
using planar_test::start;
using planar_test::Step;
using planar_test::WorldSettings;

template <class Filter>
using PlanarReacquisition = planar_test::PlanarFilter<Filter>;
TYPED_TEST_SUITE(PlanarReacquisition, planar_test::Filters, );

/// Odometry with a turn error far beyond its stated noise, and no landmark for 20 s: without
/// re-acquisition the gate rejects all landmarks for ever, with it the filter recovers.
TYPED_TEST(PlanarReacquisition, RecoversFromAGateThatRejectsGoodData) {
  WorldSettings s;
  s.position_variance = 1e-4;
  s.heading_variance = 1e-5;
  s.sigma_v = 0.01;
  s.sigma_phi = 0.002;
  const Drive d = make_drive(17, s);
  for (const bool reacquire : {false, true}) {
    TypeParam filter;
    PlanarParameters<double> parameters;
    parameters.reacquire_after = reacquire ? 10 : 0;
    ASSERT_TRUE(ok(start(filter, d, parameters)));
    int used = 0;
    int refused = 0;
    for (int k = 0; k < 1600; ++k) {
      Step step = d.steps[k];
      if (k >= 800 && k < 1000) {
        step.update = false;
        step.phi += 0.03;
      }
      const UpdateReport report = feed(filter, d, step);
      if (k < 1200) continue;
      used += report.nis_dof / 2;
      refused += report.gated;
    }
    const double error = (filter.pose().position - d.steps.back().truth.head<2>()).norm();
    if (reacquire) {
      EXPECT_GT(used, 10 * refused);
      EXPECT_GT(filter.health().reacquisitions, 0U);
      // The lifted filter's additive correction stretches its map when it is this large.
      constexpr bool kKeepsScale = !std::is_same_v<TypeParam, LiftedIekfSlam<double, 20>>;
      if (kKeepsScale) {
        EXPECT_LT(error, 0.3);
      }
    } else {
      EXPECT_GT(refused, used);
      EXPECT_GT(error, 1.0);
      EXPECT_EQ(filter.health().reacquisitions, 0U);
    }
  }
}

/// Refused updates count, predictions do not: thirty odometry steps between two updates widen as
/// often as one, and a filter that is shown nothing is left alone.
TYPED_TEST(PlanarReacquisition, WidensByRefusedUpdatesNotByPredictions) {
  this->run(0, 300);
  const LandmarkId id = this->filter_.landmark_id(0);
  const Vector2<double> wrong = this->expected(0) + Vector2<double>(4.0, -4.0);
  PlanarIncrement<double> still;
  still.covariance = 1e-10 * Matrix2<double>::Identity();
  PointObservation<double> o;
  o.id = id;
  o.y = wrong;
  o.R = 1e-4 * Matrix2<double>::Identity();
  std::uint32_t widened[2] = {};
  for (const int predictions : {1, 30}) {
    TypeParam filter = this->filter_;
    UpdateReport report;
    for (int k = 0; k < 13; ++k) {
      for (int i = 0; i < predictions; ++i) ASSERT_TRUE(ok(filter.predict(still)));
      ASSERT_TRUE(ok(filter.update_points({&o, 1}, report)));
      ASSERT_EQ(report.gated, 1);
    }
    for (int i = 0; i < 100; ++i) {
      ASSERT_TRUE(ok(filter.predict(still)));
      ASSERT_TRUE(ok(filter.update_points({&o, 0}, report)));
    }
    widened[predictions == 1 ? 0 : 1] = filter.health().reacquisitions;
  }
  // The first refusal is no repetition: the 11th, 12th and 13th update ask for a step.
  EXPECT_EQ(widened[0], 3U);
  EXPECT_EQ(widened[1], 3U);
}

/// Feeds `updates` that use `used` landmarks and refuse `again`; how many steps they ask for.
int steps_asked(detail::Reacquisition& reacquisition, int updates, int used, int again) {
  int asked = 0;
  for (int k = 0; k < updates; ++k) {
    reacquisition.note(used, again, 10, 6);
    if (reacquisition.take()) ++asked;
  }
  return asked;
}

TEST(Reacquisition, AsksForABoundedNumberOfSteps) {
  detail::Reacquisition reacquisition;
  EXPECT_EQ(steps_asked(reacquisition, 9, 1, 3), 0);
  EXPECT_EQ(steps_asked(reacquisition, 1, 2, 2), 0);  // as many accepted as refused: from zero
  EXPECT_EQ(steps_asked(reacquisition, 9, 1, 3), 0);
  EXPECT_EQ(steps_asked(reacquisition, 5, 0, 0), 0);  // nothing seen: neither counts nor ends it
  EXPECT_EQ(steps_asked(reacquisition, 1, 1, 3), 1);
  EXPECT_EQ(steps_asked(reacquisition, 1000, 1, 3), 6);
  EXPECT_FALSE(reacquisition.accepted());
  EXPECT_EQ(steps_asked(reacquisition, 1, 3, 0), 0);
  EXPECT_TRUE(reacquisition.accepted());
  EXPECT_EQ(steps_asked(reacquisition, 9, 1, 3), 0);
  EXPECT_EQ(steps_asked(reacquisition, 1, 1, 3), 1);
}

TEST(Reacquisition, EndsOnlyAfterAsManyAcceptedUpdatesAsItTookRefusedOnes) {
  detail::Reacquisition reacquisition;
  EXPECT_EQ(steps_asked(reacquisition, 12, 1, 3), 3);
  EXPECT_EQ(steps_asked(reacquisition, 9, 2, 0), 0);
  EXPECT_EQ(steps_asked(reacquisition, 2, 1, 3), 2);  // goes on where it was
  EXPECT_EQ(reacquisition.steps(), 5);
  EXPECT_EQ(steps_asked(reacquisition, 10, 2, 0), 0);
  EXPECT_EQ(reacquisition.steps(), 0);
  EXPECT_EQ(steps_asked(reacquisition, 9, 1, 3), 0);
}

/// A landmark that was moved is followed after a while; the pose does not suffer.
TYPED_TEST(PlanarReacquisition, FollowsALandmarkThatWasMoved) {
  WorldSettings s;
  s.position_variance = 1e-4;
  s.heading_variance = 1e-5;
  s.loops = 4;
  const Drive d = make_drive(23, s);
  TypeParam filter;
  ASSERT_TRUE(ok(start(filter, d)));
  const Eigen::Vector2d shift(0.9, -0.7);
  LandmarkId moved = kNoLandmark;
  for (std::size_t k = 0; k < d.steps.size(); ++k) {
    Step step = d.steps[k];
    if (k == 800) moved = filter.landmark_id(0);
    for (Sighting& sighting : step.sightings) {
      if (sighting.id == moved) {
        sighting.y += planar_test::rotation(step.truth(2)).transpose() * shift;
      }
    }
    feed(filter, d, step);
  }
  ASSERT_NE(moved, kNoLandmark);
  const Eigen::Vector2d place = d.landmarks[moved - 1] + shift;
  EXPECT_LT((filter.landmark_position(filter.find(moved)) - place).norm(), 0.3);
  EXPECT_LT((filter.pose().position - d.steps.back().truth.head<2>()).norm(), 0.3);
  EXPECT_GT(filter.health().reacquisitions, 0U);
}

}  // namespace
}  // namespace cairn
