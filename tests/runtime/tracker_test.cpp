#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "cairn/planar/group_iekf_slam.hpp"
#include "cairn/runtime/augmentation.hpp"
#include "cairn/runtime/handheld_tracker.hpp"
#include "cairn/runtime/vehicle_tracker.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

using Handheld = HandheldTracker<TinyConfig>;
using Filter = GroupIekfSlam<float, TinyConfig::kMaxLandmarks, 3>;
using Vehicle = VehicleTracker<TinyConfig, Filter>;
using Image = std::vector<std::uint8_t>;

template <class Tracker>
std::uint64_t hash_of(const Tracker& tracker) {
  Hash64 hash;
  tracker.hash(hash);
  return hash.value();
}

/// GIVEN a camera that moves sideways before a textured wall.
class HandheldAtAWall : public ::testing::Test {
 protected:
  static constexpr int kFrames = 25;
  static constexpr std::int64_t kStepUs = 33333;

  static void SetUpTestSuite() {
    const test::PlaneScene scene(1.5);
    for (int k = 0; k < kFrames; ++k) {
      const double t = 0.004 * k * k / kFrames;  // starts at rest
      frames().push_back(scene.render(test::small_camera(),
                                      {rotation_exp(Vector3<double>(0, t, 0)), {-5 * t, t, 0}}));
    }
  }
  static void TearDownTestSuite() { frames().clear(); }
  static std::vector<Image>& frames() {
    static std::vector<Image> all;
    return all;
  }

  HandheldAtAWall() {
    EXPECT_TRUE(ok(tracker_->initialise(test::to_float(test::small_camera()), {})));
  }
  Status step(Handheld& tracker, int k, FrameReport& report) const {
    return tracker.process_frame(
        test::view(frames()[static_cast<std::size_t>(k)], test::small_camera()), k * kStepUs,
        TickSource{}, report);
  }

  std::unique_ptr<Handheld> tracker_ = std::make_unique<Handheld>();
  FrameReport report_;
};

TEST_F(HandheldAtAWall, IsTracked) {
  for (int k = 0; k < kFrames; ++k) static_cast<void>(step(*tracker_, k, report_));
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_GE(report_.inliers, 8);
  const Vector3<float> turned = rotation_log(report_.T_world_camera.rotation);
  EXPECT_NEAR(turned.y(), 0.004 * (kFrames - 1) * (kFrames - 1) / kFrames, 0.05);
}

TEST_F(HandheldAtAWall, RefusedFramesLeaveTheTrackerUnchanged) {
  for (int k = 0; k < 5; ++k) static_cast<void>(step(*tracker_, k, report_));
  const std::uint64_t before = hash_of(*tracker_);
  EXPECT_EQ(step(*tracker_, 4, report_), Status::kDuplicate);
  EXPECT_EQ(step(*tracker_, 3, report_), Status::kTimeBackwards);
  EXPECT_EQ(tracker_->process_frame(ImageView{}, 1000000, TickSource{}, report_),
            Status::kInvalidArgument);
  const ImageView narrow{frames()[0].data(), 319, 240, 320};
  EXPECT_EQ(tracker_->process_frame(narrow, 1000000, TickSource{}, report_),
            Status::kInvalidArgument);
  EXPECT_EQ(hash_of(*tracker_), before);
  EXPECT_EQ(tracker_->health().time_errors, 2U);
}

TEST_F(HandheldAtAWall, InstancesDoNotTouchEachOther) {
  auto other = std::make_unique<Handheld>();
  ASSERT_TRUE(ok(other->initialise(test::to_float(test::small_camera()), {})));
  for (int k = 0; k < 12; ++k) {
    static_cast<void>(step(*tracker_, k, report_));
    static_cast<void>(step(*other, k, report_));
    ASSERT_EQ(hash_of(*tracker_), hash_of(*other)) << "frame " << k;
  }
}

TEST_F(HandheldAtAWall, KeepsAGoodStart) {
  for (int k = 0; k < kFrames; ++k) static_cast<void>(step(*tracker_, k, report_));
  EXPECT_EQ(tracker_->health().losses, 0U);
  EXPECT_EQ(tracker_->filter().health().resets, 0U);
}

TEST_F(HandheldAtAWall, SaysThatAStartWhichDoesNotFitIsLostAndBeginsAnewAtItsPose) {
  // GIVEN a trial that no start passes, of blocks of eight frames, and one restart allowed
  Handheld::Parameters parameters;
  parameters.start.max_misfit = 1e-6F;
  parameters.start.block_frames = 8;
  parameters.start.max_restarts = 1;
  ASSERT_TRUE(ok(tracker_->initialise(test::to_float(test::small_camera()), parameters)));
  Rigid<float> before;
  for (int k = 0; k < kFrames; ++k) {
    before = tracker_->filter().T_world_camera();
    const Status status = step(*tracker_, k, report_);
    if (k != 7) {
      EXPECT_NE(status, Status::kLost) << k;
      continue;
    }
    // THEN its first block's last frame is lost, and the pose goes on from there
    EXPECT_EQ(status, Status::kLost);
    EXPECT_EQ(report_.state, TrackingState::kLost);
    EXPECT_EQ(tracker_->filter().feature_count(), 0);
    EXPECT_LT((report_.T_world_camera.translation - before.translation).norm(), 0.1F);
  }
  EXPECT_EQ(tracker_->health().losses, 1U);
  EXPECT_EQ(tracker_->filter().health().resets, 1U);
  EXPECT_EQ(report_.state, TrackingState::kTracking);
}

TEST_F(HandheldAtAWall, IsCalledLostWhenNothingIsSeenForLong) {
  for (int k = 0; k < kFrames; ++k) static_cast<void>(step(*tracker_, k, report_));
  const Image black(320 * 240, 0);
  for (int k = kFrames; k < kFrames + 40; ++k) {
    static_cast<void>(tracker_->process_frame(test::view(black, test::small_camera()), k * kStepUs,
                                              TickSource{}, report_));
  }
  EXPECT_EQ(report_.state, TrackingState::kLost);
  EXPECT_EQ(report_.status, Status::kLost);
  EXPECT_EQ(tracker_->health().losses, 1U);
}

TEST(HandheldTracker, RefusesWhatItCannotHold) {
  auto tracker = std::make_unique<Handheld>();
  FrameReport report;
  const Image image(320 * 240, 0);
  EXPECT_EQ(
      tracker->process_frame(test::view(image, test::small_camera()), 0, TickSource{}, report),
      Status::kNotInitialised);
  PinholeCamera<float> camera = test::to_float(test::small_camera());
  camera.width = TinyConfig::kMaxImageWidth + 1;
  EXPECT_EQ(tracker->initialise(camera, {}), Status::kBadConfig);
  camera = test::to_float(test::small_camera());
  camera.fx = 0.0F;
  EXPECT_EQ(tracker->initialise(camera, {}), Status::kBadConfig);
}

/// GIVEN a vehicle that drives past a wall on its left, which its camera looks at, with odometry
/// that reads 5 % too fast.
class VehicleAtAWall : public ::testing::Test {
 protected:
  static constexpr int kFrames = 45;
  static constexpr double kStep = 0.02;
  static constexpr std::int64_t kStepUs = 33333;

  static void SetUpTestSuite() {
    const test::PlaneScene scene(2.0, 0.22);
    for (int k = 0; k < kFrames; ++k) {
      frames().push_back(
          scene.render(test::small_camera(), {Quaternion<double>::Identity(), {k * kStep, 0, 0}}));
    }
  }
  static void TearDownTestSuite() { frames().clear(); }
  static std::vector<Image>& frames() {
    static std::vector<Image> all;
    return all;
  }

  VehicleAtAWall() { start(*tracker_); }

  static void start(Vehicle& tracker) {
    // Camera x along the vehicle's x, camera y down, camera z to the left: a quarter turn about x.
    const Rigid<float> T_vehicle_camera{{0.70710678F, -0.70710678F, 0.0F, 0.0F},
                                        {0.0F, 0.0F, 1.0F}};
    Vehicle::Start start;
    start.covariance = 1e-8F * Matrix3<float>::Identity();
    Vehicle::Parameters parameters;
    parameters.odometry = {0.05F, 0.02F, 0.5F, 0.033333F};
    ASSERT_TRUE(ok(tracker.initialise(test::to_float(test::small_camera()), T_vehicle_camera, start,
                                      parameters)));
  }
  static Status step(Vehicle& tracker, int k, FrameReport& report) {
    OdometrySample sample;
    sample.t_us = k * kStepUs;
    sample.speed_mps = k == 0 ? 0.0F : static_cast<float>(1.05 * kStep / 0.033333);
    static_cast<void>(tracker.add_odometry(sample));
    return tracker.process_frame(
        test::view(frames()[static_cast<std::size_t>(k)], test::small_camera()), k * kStepUs,
        TickSource{}, report);
  }

  std::unique_ptr<Vehicle> tracker_ = std::make_unique<Vehicle>();
  FrameReport report_;
};

TEST_F(VehicleAtAWall, BuildsAMapAndKeepsItsHeading) {
  for (int k = 0; k < kFrames; ++k) static_cast<void>(step(*tracker_, k, report_));
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_GE(report_.inliers, 5);
  const PlanarPose<float> pose = tracker_->filter().mean_pose();
  // The scale is the wheels', 5 % too long. The wall determines heading and lateral position.
  EXPECT_NEAR(pose.position.x(), 1.05 * kStep * (kFrames - 1), 0.05);
  EXPECT_NEAR(pose.position.y(), 0.0, 0.02);
  EXPECT_NEAR(pose.heading, 0.0, 0.01);
}

/// Odometry begins later than the pictures, of a vehicle that moves already: what is followed until
/// then, as if at rest, must not become its map.
TEST_F(VehicleAtAWall, MapsNothingBeforeItsFirstSample) {
  constexpr int kSilent = 6;
  for (int k = 0; k < kFrames; ++k) {
    if (k >= kSilent) {
      static_cast<void>(step(*tracker_, k, report_));
      if (k == kSilent) {
        EXPECT_EQ(report_.added, 0) << "a depth takes three views";
      }
      continue;
    }
    static_cast<void>(tracker_->process_frame(
        test::view(frames()[static_cast<std::size_t>(k)], test::small_camera()), k * kStepUs,
        TickSource{}, report_));
    EXPECT_EQ(report_.not_tracked, NotTracked::kNoOdometry);
    EXPECT_LE(report_.landmarks, 1) << "the positions of keyframes, of which none lasts";
  }
  EXPECT_EQ(report_.state, TrackingState::kTracking);
  EXPECT_GE(report_.inliers, 5);
  const PlanarPose<float> pose = tracker_->filter().mean_pose();
  EXPECT_NEAR(pose.position.x(), 1.05 * kStep * (kFrames - 1), 0.05);
  EXPECT_NEAR(pose.position.y(), 0.0, 0.02);
  EXPECT_NEAR(pose.heading, 0.0, 0.01);
}

TEST_F(VehicleAtAWall, SameInputGivesTheSameBytes) {
  auto other = std::make_unique<Vehicle>();
  start(*other);
  for (int k = 0; k < 20; ++k) {
    static_cast<void>(step(*tracker_, k, report_));
    static_cast<void>(step(*other, k, report_));
    ASSERT_EQ(hash_of(*tracker_), hash_of(*other)) << "frame " << k;
  }
}

/// With noise linearised at an outlier, distance and turn would be correlated with the sign of the
/// reading's own error, and every correction of the heading would shorten the distance travelled.
TEST_F(VehicleAtAWall, ASteeringOutlierDoesNotCorrelateDistanceAndTurn) {
  OdometrySample sample;
  sample.kind = OdometrySample::Kind::kAckermann;
  sample.speed_mps = 0.5F;
  for (int k = 1; k <= 30; ++k) {
    sample.t_us = k * kStepUs;
    sample.turn = k == 30 ? 0.4F : 0.0F;
    ASSERT_TRUE(ok(tracker_->add_odometry(sample)));
  }
  const Matrix3<float> c = tracker_->filter().pose_covariance();
  const float correlation = c(0, 2) / std::sqrt(c(0, 0) * c(2, 2));
  EXPECT_LT(std::abs(correlation), 0.02F);
}

/// An outlier of the steering must not move the landmarks out of their search windows.
TEST_F(VehicleAtAWall, ASteeringOutlierWidensTheHeading) {
  OdometrySample sample;
  sample.kind = OdometrySample::Kind::kAckermann;
  sample.speed_mps = 0.5F;
  const auto heading_variance = [&] { return tracker_->filter().pose_covariance()(2, 2); };
  constexpr int kOutlier = 30;
  for (int k = 1; k < kOutlier; ++k) {
    sample.t_us = k * kStepUs;
    ASSERT_TRUE(ok(tracker_->add_odometry(sample)));
  }
  const float heading = tracker_->filter().pose().heading;
  const float before = heading_variance();
  sample.t_us = kOutlier * kStepUs;
  sample.turn = 0.7F;
  ASSERT_TRUE(ok(tracker_->add_odometry(sample)));
  const float turned = std::abs(tracker_->filter().pose().heading - heading);
  const float opened = std::sqrt(heading_variance() - before);
  EXPECT_GT(turned, 0.0F);
  constexpr float kWindow = 4.29F;  // sigmas at 99.99 %
  EXPECT_LT(turned, kWindow * opened);
}

TEST_F(VehicleAtAWall, BadOdometryIsRefusedAndCounted) {
  for (int k = 0; k < 3; ++k) static_cast<void>(step(*tracker_, k, report_));
  const std::uint64_t before = hash_of(*tracker_);
  OdometrySample bad;
  bad.t_us = 1000000;
  bad.speed_mps = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(tracker_->add_odometry(bad), Status::kNonFiniteInput);
  EXPECT_EQ(hash_of(*tracker_), before);
  EXPECT_EQ(tracker_->health().non_finite_inputs, 1U);
}

TEST_F(VehicleAtAWall, DrawsAnObjectOnceItTracks) {
  VirtualObject shape;
  ASSERT_TRUE(ok(make_cairn(1.0F, shape)));
  Augmenter augmenter;
  augmenter.initialise(shape, {});
  ObjectPlacement placement{{3.5F, 0.7F, 0.0F}, Random(1)};
  for (int k = 0; k < kFrames; ++k) {
    static_cast<void>(step(*tracker_, k, report_));
    Image overlay = frames()[static_cast<std::size_t>(k)];
    augment(*tracker_, augmenter, placement, {overlay.data(), 320, 240, 320}, TickSource{},
            report_);
  }
  EXPECT_GE(augmenter.size(), 1);
}

}  // namespace
}  // namespace cairn
