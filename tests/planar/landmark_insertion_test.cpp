#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/planar/lifted/lifted_iekf_slam.hpp"

namespace cairn {
namespace {

constexpr LandmarkId kPast = 100;
constexpr LandmarkId kNew = 1;

using Ekf = EkfSlam<double, 8, 3>;
using Group = GroupIekfSlam<double, 8, 3>;

/// GIVEN a filter that remembered a position and drove on from there.
template <class Filter>
class LandmarkOnPath : public ::testing::Test {
 protected:
  LandmarkOnPath() {
    PlanarPose<double> pose;
    pose.position = {1.0, -2.0};
    pose.heading = 0.7;
    EXPECT_TRUE(ok(filter_.initialise(pose, Vector3<double>(0.01, 0.02, 0.001).asDiagonal())));
    EXPECT_TRUE(ok(filter_.add_position(kPast)));
    for (int k = 0; k < 10; ++k) {
      EXPECT_TRUE(ok(filter_.predict(twist_increment(0.5, 0.1, 0.1, 0.1, 0.02))));
    }
  }

  /// Covariance of the displacement since the remembered position, in the filter's error
  /// coordinates.
  Matrix2<double> displacement_covariance() const {
    constexpr int kPosition = std::is_same_v<Filter, Group> ? 1 : 0;
    Matrix2<double> c;
    for (int i = 0; i < 2; ++i) {
      for (int j = 0; j < 2; ++j) {
        c(i, j) = at(kPosition + i, kPosition + j) - at(kPosition + i, 3 + j) -
                  at(3 + i, kPosition + j) + at(3 + i, 3 + j);
      }
    }
    return c;
  }
  double at(int i, int j) const { return filter_.error_covariance(i, j); }

  Filter filter_;
  const Vector3<double> y_{3.0, 1.0, 0.5};
  const Matrix3<double> tiny_ = 1e-9 * Matrix3<double>::Identity();
};

using Filters = ::testing::Types<Ekf, Group>;
TYPED_TEST_SUITE(LandmarkOnPath, Filters, );

TYPED_TEST(LandmarkOnPath, RemembersThePositionExactly) {
  TypeParam filter;
  PlanarPose<double> pose;
  pose.position = {1.0, -2.0};
  pose.heading = 0.7;
  ASSERT_TRUE(ok(filter.initialise(pose, Vector3<double>(0.01, 0.02, 0.001).asDiagonal())));
  ASSERT_TRUE(ok(filter.add_position(kPast)));
  constexpr int kPosition = std::is_same_v<TypeParam, Group> ? 1 : 0;
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(filter.mean_landmark(0)(i), pose.position(i), 1e-12);
    for (int j = 0; j < 3; ++j) {
      EXPECT_NEAR(filter.error_covariance(3 + i, j), filter.error_covariance(kPosition + i, j),
                  1e-12);
    }
  }
}

TYPED_TEST(LandmarkOnPath, SharesTheErrorOfTheDistanceTravelled) {
  // WHEN a landmark is triangulated over half a metre straight ahead
  Matrix<double, 3, 2> by_path = Matrix<double, 3, 2>::Zero();
  by_path.col(0) = this->y_ / 0.5;
  ASSERT_TRUE(ok(this->filter_.add_landmark_on_path(kNew, this->y_, this->tiny_, kPast, by_path)));
  // THEN the error of its place relative to the vehicle is that of the half metre, times six along
  // x.
  const double heading = this->filter_.mean_pose().heading;
  Matrix2<double> R;
  R << std::cos(heading), -std::sin(heading), std::sin(heading), std::cos(heading);
  const Matrix2<double> gain = R * by_path.topRows<2>() * R.transpose();
  const Matrix2<double> expected = gain * this->displacement_covariance() * gain.transpose();
  constexpr bool kGroup = std::is_same_v<TypeParam, Group>;
  constexpr int kPosition = kGroup ? 1 : 0;
  const Vector3<double> p = this->filter_.mean_landmark(1);
  const auto pose = this->filter_.mean_pose();
  const double turn[2] = {kGroup ? 0.0 : pose.position.y() - p.y(),
                          kGroup ? 0.0 : p.x() - pose.position.x()};
  const int heading_state = kGroup ? 0 : 2;
  // Relative error: landmark - vehicle - what the heading turns.
  const auto relative = [&](int i, int state) {
    return this->at(6 + i, state) - this->at(kPosition + i, state) -
           turn[i] * this->at(heading_state, state);
  };
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) {
      const double c =
          relative(i, 6 + j) - relative(i, kPosition + j) - turn[j] * relative(i, heading_state);
      EXPECT_NEAR(c, expected(i, j), 1e-8) << i << j;
    }
  }
}

TYPED_TEST(LandmarkOnPath, RefusesWhatItCannotUseAndStaysAsItWas) {
  Hash64 before;
  this->filter_.hash(before);
  const Matrix<double, 3, 2> none = Matrix<double, 3, 2>::Zero();
  EXPECT_EQ(this->filter_.add_landmark_on_path(kNew, this->y_, this->tiny_, 55, none),
            Status::kNotFound);
  EXPECT_EQ(this->filter_.add_landmark_on_path(kPast, this->y_, this->tiny_, kPast, none),
            Status::kDuplicate);
  EXPECT_EQ(this->filter_.add_landmark_on_path(kNew, this->y_, -this->tiny_, kPast, none),
            Status::kInvalidArgument);
  EXPECT_EQ(this->filter_.add_position(kNoLandmark), Status::kInvalidArgument);
  EXPECT_EQ(this->filter_.add_position(kPast), Status::kDuplicate);
  Hash64 after;
  this->filter_.hash(after);
  EXPECT_EQ(before.value(), after.value());
}

TYPED_TEST(LandmarkOnPath, NeverReplacesARememberedPosition) {
  for (LandmarkId id = 1; id < 8; ++id) {
    ASSERT_TRUE(ok(this->filter_.add_landmark(id, this->y_, Matrix3<double>::Identity())));
  }
  for (LandmarkId id = 10; id < 30; ++id) {
    static_cast<void>(this->filter_.add_landmark(id, this->y_, Matrix3<double>::Identity()));
  }
  EXPECT_GE(this->filter_.find(kPast), 0);
}

/// A landmark known in the world does not change the pose's covariance, and has its own
/// covariance whatever the heading's is.
TYPED_TEST(LandmarkOnPath, ALandmarkOfTheWorldKeepsItsCovariance) {
  const Matrix3<double> own = Vector3<double>(0.04, 0.09, 0.01).asDiagonal();
  ASSERT_TRUE(ok(this->filter_.add_world_landmark(kNew, {4.0, 3.0, 0.5}, own)));
  const Matrix3<double> got = this->filter_.landmark_covariance(1);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(got(i, i), own(i, i), 2e-3) << i;
  EXPECT_NEAR(this->filter_.mean_landmark(1).x(), 4.0, 1e-12);
}

/// Landmarks of one old map: what they share counts once, wherever they are and whatever the
/// heading's variance is.
TYPED_TEST(LandmarkOnPath, LandmarksOfOneMapShareTheErrorOfTheirReference) {
  constexpr LandmarkId kReference = 70;
  constexpr LandmarkId kOther = 71;
  const Matrix3<double> shared = Vector3<double>(0.04, 0.09, 0.01).asDiagonal();
  const Matrix3<double> own = 1e-3 * Matrix3<double>::Identity();
  ASSERT_TRUE(ok(this->filter_.add_world_landmark(kReference, {1.0, -2.0, 0.0}, shared)));
  ASSERT_TRUE(ok(this->filter_.add_world_landmark(kNew, {4.0, 3.0, 0.5}, own, kReference)));
  ASSERT_TRUE(ok(this->filter_.add_world_landmark(kOther, {-5.0, 2.0, 1.5}, own, kReference)));
  for (const LandmarkId id : {kNew, kOther}) {
    const Matrix3<double> got = this->filter_.landmark_covariance(this->filter_.find(id));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(got(i, i), shared(i, i) + own(i, i), 2e-3) << i;
  }
  EXPECT_EQ(this->filter_.add_world_landmark(72, {0, 0, 0}, own, 99), Status::kNotFound);
}

/// The frame of an old map is unsure beside the vehicle by what it was begun with: where the
/// vehicle is in it, not where the two are.
TYPED_TEST(LandmarkOnPath, AFrameOfAnOldMapMovesWithTheVehicle) {
  constexpr LandmarkId kOrigin = 70;
  constexpr LandmarkId kAhead = 71;
  Matrix3<double> offset = Vector3<double>(0.04, 0.09, 1e-4).asDiagonal();
  offset(0, 1) = offset(1, 0) = 0.02;
  const Matrix3<double> turn = Vector3<double>(1e-9, 0.0025, 1e-9).asDiagonal();
  const Vector2<double> here = this->filter_.mean_pose().position;
  ASSERT_TRUE(ok(this->filter_.add_frame_position(kOrigin, {here.x(), here.y(), 0.0}, offset)));
  ASSERT_TRUE(ok(
      this->filter_.add_frame_position(kAhead, {here.x() + 10.0, here.y(), 0.0}, turn, kOrigin)));
  const Matrix3<double> framed = this->filter_.framed_pose_covariance(kOrigin, kAhead);
  EXPECT_LT((framed - framed.transpose()).norm(), 1e-12);
  const Matrix2<double> in_plane = (framed - offset).template topLeftCorner<2, 2>();
  EXPECT_LT(in_plane.norm(), 1e-6);
  EXPECT_NEAR(framed(2, 2), 0.0025 / 100.0, 1e-9);
}

/// A drift of vehicle and landmarks together makes the pose unsure, and nothing that is seen.
TYPED_TEST(LandmarkOnPath, NoSightingShowsADriftOfTheWorld) {
  ASSERT_TRUE(ok(this->filter_.add_landmark(kNew, this->y_, 0.01 * Matrix3<double>::Identity())));
  const int slot = this->filter_.find(kNew);
  const Matrix3<double> pose = this->filter_.pose_covariance();
  const Matrix3<double> own = this->filter_.own_pose_covariance();
  const Matrix3<double> seen = this->filter_.relative_landmark_covariance(slot);
  const double landmark = this->filter_.landmark_covariance(slot).trace();
  ASSERT_TRUE(ok(this->filter_.drift_world(0.01, 0.0004)));
  constexpr bool kGroup = std::is_same_v<TypeParam, Group>;
  const Matrix3<double> grown = this->filter_.pose_covariance() - pose;
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(grown(i, i), kGroup ? 0.01 : 0.0, 1e-4) << i;
  EXPECT_NEAR(grown(2, 2), kGroup ? 0.0004 : 0.0, 1e-9);
  EXPECT_EQ(this->filter_.own_pose_covariance(), kGroup ? own : pose);
  EXPECT_EQ(this->filter_.relative_landmark_covariance(slot), seen);
  const double turned = 0.0004 * (square(this->y_.x()) + square(this->y_.y()));
  EXPECT_NEAR(this->filter_.landmark_covariance(slot).trace() - landmark,
              kGroup ? 0.02 + turned : 0.0, 1e-3);
  EXPECT_EQ(this->filter_.drift_world(-0.1, 0.0), Status::kInvalidArgument);
}

TEST(LandmarkOnPathLifted, TakesTheDistanceTravelledAsIndependentNoise) {
  LiftedIekfSlam<double, 8, 3> filter;
  ASSERT_TRUE(ok(filter.initialise({}, 1e-4 * Matrix3<double>::Identity())));
  ASSERT_TRUE(ok(filter.add_position(kPast)));
  for (int k = 0; k < 10; ++k) {
    ASSERT_TRUE(ok(filter.predict(twist_increment(0.5, 0.1, 0.1, 0.1, 0.02))));
  }
  Matrix<double, 3, 2> by_path = Matrix<double, 3, 2>::Zero();
  by_path(0, 0) = 6.0;
  const Matrix3<double> tiny = 1e-9 * Matrix3<double>::Identity();
  ASSERT_TRUE(ok(filter.add_landmark_on_path(kNew, {3.0, 0.0, 0.5}, tiny, kPast, by_path)));
  // Ten steps of 1 cm deviation each, six times.
  EXPECT_GT(filter.landmark_covariance(1)(0, 0), 36.0 * 10.0 * 1e-4 * 0.9);
}

}  // namespace
}  // namespace cairn
