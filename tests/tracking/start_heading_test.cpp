#include "cairn/tracking/start_heading.hpp"

#include <gtest/gtest.h>

#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/tracking/planar_pose_search.hpp"

namespace cairn {
namespace {

constexpr LandmarkId kFirst = 7;

/// What the pictures say of the turn since keyframe kFirst.
struct SeenTurn {
  Quaternion<float> now_then;
  float variance = 1e-8F;
  Rigid<float> T_world_camera;

  bool turn_since(LandmarkId keyframe, Quaternion<float>& turn, float& yaw_variance) const {
    turn = now_then;
    yaw_variance = variance;
    return keyframe == kFirst;
  }
  void stand_at(const Rigid<float>& T) { T_world_camera = T; }
};

struct Estimate {
  using Filter = GroupIekfSlam<float, 8, 3>;

  const Filter& filter() const { return slam; }
  Filter& filter() { return slam; }
  const TrackedLandmarks<8>& landmarks() const { return records; }
  const Rigid<float>& T_vehicle_camera() const { return mount; }

  Filter slam;
  TrackedLandmarks<8> records;
  Rigid<float> mount = {{0.5F, -0.5F, 0.5F, -0.5F}, {0.2F, 0.0F, 1.0F}};
};

struct Numbers {
  static Rigid<float> T_world_camera(const Estimate& estimate) {
    return on_floor(estimate.filter().mean_pose()) * estimate.T_vehicle_camera();
  }
};

/// GIVEN a vehicle at heading 0.4 rad whose odometry turns it by 0.05 +- 0.02 rad from its first
/// keyframe on, where the seeds saw it turn by 0.02 rad.
class HeadingOfAStart : public ::testing::Test {
 protected:
  HeadingOfAStart() {
    PlanarPose<float> pose;
    pose.heading = 0.4F;
    EXPECT_TRUE(ok(estimate_.slam.initialise(pose, 1e-6F * Matrix3<float>::Identity(), {})));
    EXPECT_TRUE(ok(estimate_.slam.add_position(kFirst)));
    keyframes_.push_back(kFirst);
    heading_.begin(estimate_);
    PlanarIncrement<float> turn;
    turn.distance_m = 0.1F;
    turn.turn_rad = 0.05F;
    turn.covariance = Matrix2<float>::Zero();
    turn.covariance(0, 0) = 1e-4F;
    turn.covariance(1, 1) = 4e-4F;
    EXPECT_TRUE(ok(estimate_.slam.predict(turn)));
    const Quaternion<float> left = rotation_exp(Vector3<float>(0.0F, 0.0F, 0.02F));
    const Quaternion<float>& mount = estimate_.mount.rotation;
    seeds_.now_then = mount.conjugate() * left.conjugate() * mount;
  }

  float taken() {
    heading_.take<Numbers>(seeds_, keyframes_, estimate_);
    return estimate_.slam.mean_pose().heading;
  }

  Estimate estimate_;
  SeenTurn seeds_;
  FixedVector<LandmarkId, 4> keyframes_;
  StartHeading heading_;
};

TEST_F(HeadingOfAStart, IsThatOfThePicturesWhereTheyAreSurer) {
  EXPECT_NEAR(taken(), 0.42F, 1e-5F);
  EXPECT_LT(estimate_.slam.own_pose_covariance()(2, 2), 1e-6F);
  const Rigid<float> now = Numbers::T_world_camera(estimate_);
  EXPECT_LT(seeds_.T_world_camera.rotation.angularDistance(now.rotation), 1e-5F)
      << "the correction is no motion";
}

TEST_F(HeadingOfAStart, IsTheOdometrysWhereThatIsNearlyAsGood) {
  seeds_.variance = 1e-5F;
  EXPECT_NEAR(taken(), 0.45F, 1e-5F);
}

/// By more than three of odometry's standard deviations: one of the two is wrong.
TEST_F(HeadingOfAStart, IsTheOdometrysWhereThePicturesContradictIt) {
  const Quaternion<float> far = rotation_exp(Vector3<float>(0.0F, 0.0F, 0.12F));
  const Quaternion<float>& mount = estimate_.mount.rotation;
  seeds_.now_then = mount.conjugate() * far.conjugate() * mount;
  EXPECT_NEAR(taken(), 0.45F, 1e-5F);
}

/// The map begins after a gap: how unsure the heading was at the keyframe says nothing about the
/// turn since then.
TEST_F(HeadingOfAStart, IsTheOdometrysWhereAnUnsureHeadingHidesTheContradiction) {
  Estimate unsure;
  EXPECT_TRUE(ok(unsure.slam.initialise({}, 0.3F * Matrix3<float>::Identity(), {})));
  EXPECT_TRUE(ok(unsure.slam.add_position(kFirst)));
  heading_.begin(unsure);
  PlanarIncrement<float> turn;
  turn.turn_rad = 0.05F;
  turn.covariance(1, 1) = 4e-4F;
  EXPECT_TRUE(ok(unsure.slam.predict(turn)));
  const Quaternion<float> far = rotation_exp(Vector3<float>(0.0F, 0.0F, 0.2F));
  const Quaternion<float>& mount = unsure.mount.rotation;
  seeds_.now_then = mount.conjugate() * far.conjugate() * mount;
  heading_.take<Numbers>(seeds_, keyframes_, unsure);
  EXPECT_NEAR(unsure.slam.mean_pose().heading, 0.05F, 1e-5F);
}

TEST_F(HeadingOfAStart, IsTheFiltersOnceThereIsALandmark) {
  TrackedLandmark landmark;
  landmark.id = 9;
  estimate_.records.add(landmark);
  EXPECT_NEAR(taken(), 0.45F, 1e-5F);
  estimate_.records.clear();
  EXPECT_NEAR(taken(), 0.45F, 1e-5F) << "and stays that";
}

TEST_F(HeadingOfAStart, IsTheOdometrysWhenTheKeyframeIsGone) {
  keyframes_[0] = kFirst + 1;
  EXPECT_NEAR(taken(), 0.45F, 1e-5F);
  keyframes_[0] = kFirst;
  heading_.forget();
  EXPECT_NEAR(taken(), 0.45F, 1e-5F);
}

}  // namespace
}  // namespace cairn
