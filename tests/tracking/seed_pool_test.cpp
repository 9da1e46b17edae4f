#include "cairn/tracking/seed_pool.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "cairn/vision/fast.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

using Pool = SeedPool<16, 4>;
using test::PlaneScene;

/// GIVEN seeds on a plane 3 m ahead, started without knowledge of their depth.
class SeedDepth : public ::testing::Test {
 protected:
  static constexpr double kDepth = 3.0;
  static constexpr LandmarkId kKeyframe = 7;

  void start() {
    const auto image = scene_.render(camera_, Rigid<double>{});
    FastScratch<320> scratch;
    Corner corners[64];
    FastReport report;
    ASSERT_TRUE(ok(detect_fast(test::view(image, camera_), {60, 60, 260, 180}, 40, scratch, corners,
                               64, report)));
    pool_.follow(test::view(image, camera_), test::to_float(camera_), Rigid<float>{}, parameters_,
                 unlimited_);
    ASSERT_TRUE(ok(pool_.begin_keyframe(kKeyframe)));
    for (int i = 0; i < report.found - report.dropped && !pool_.full(); i += 3) {
      static_cast<void>(pool_.add(test::view(image, camera_), test::to_float(camera_), corners[i].x,
                                  corners[i].y, kKeyframe, parameters_));
    }
    ASSERT_GE(pool_.size(), 5);
  }

  PinholeCamera<double> camera_ = test::small_camera();
  PlaneScene scene_{kDepth};
  Pool pool_;
  WorkBudget unlimited_;
  Pool::Parameters parameters_;
};

TEST_F(SeedDepth, IsFoundBySidewaysMotion) {
  start();
  const int started = pool_.size();
  int landmarks = 0;
  // WHEN the camera moves sideways by 5 cm a frame
  for (int k = 1; k <= 12; ++k) {
    const Rigid<double> T{Quaternion<double>::Identity(), {0.05 * k, 0, 0}};
    const auto image = scene_.render(camera_, T);
    pool_.follow(test::view(image, camera_), test::to_float(camera_), test::to_float(T),
                 parameters_, unlimited_);
    ConvergedSeed converged;
    while (pool_.take_converged(test::to_float(camera_), parameters_, converged)) {
      ++landmarks;
      // THEN the depths of those converged are right within their own sigma.
      const float sigma = converged.sigma_depth_m;
      EXPECT_NEAR(converged.depth_m, kDepth, 3.0 * static_cast<double>(sigma));
      EXPECT_LT(sigma, 0.5F);
      EXPECT_EQ(converged.keyframe, kKeyframe);
    }
  }
  EXPECT_GE(landmarks * 2, started);
}

TEST_F(SeedDepth, WaitsWhileTheWaySinceItsKeyframeIsNotKnown) {
  start();
  for (int k = 1; k <= 12; ++k) {
    const Rigid<double> T{Quaternion<double>::Identity(), {0.05 * k, 0, 0}};
    const auto image = scene_.render(camera_, T);
    pool_.follow(test::view(image, camera_), test::to_float(camera_), test::to_float(T),
                 parameters_, unlimited_);
    ConvergedSeed converged;
    const auto unknown = [](LandmarkId keyframe) { return keyframe != kKeyframe; };
    EXPECT_FALSE(pool_.take_converged(test::to_float(camera_), parameters_, unknown, converged));
  }
  const int waiting = pool_.size();
  int landmarks = 0;
  ConvergedSeed converged;
  while (pool_.take_converged(test::to_float(camera_), parameters_, converged)) ++landmarks;
  EXPECT_GE(2 * landmarks, waiting);
}

/// At the first picture of a moving vehicle its speed may not be known yet, and with it the depth
/// that seeds begin with.
TEST_F(SeedDepth, IsThatOfThePresentParametersUntilASecondPicture) {
  const Pool::Parameters known = parameters_;
  parameters_.initial_depth_m = 0.6F;
  parameters_.initial_sigma_rho = 0.1F;
  start();
  const int started = pool_.size();
  const auto follow = [&](int k) {
    const Rigid<double> T{Quaternion<double>::Identity(), {0.1 * k, 0, 0}};
    const auto image = scene_.render(camera_, T);
    pool_.follow(test::view(image, camera_), test::to_float(camera_), test::to_float(T),
                 parameters_, unlimited_);
  };
  const auto right = [&] {
    int count = 0;
    for (int i = 0; i < pool_.size(); ++i) {
      count += std::abs(1.0 / static_cast<double>(pool_[i].rho) - kDepth) < 0.7 ? 1 : 0;
    }
    return count;
  };
  parameters_ = known;
  follow(1);
  EXPECT_GE(4 * right(), 3 * started);
  // Later the depth is the pictures' to tell.
  parameters_.initial_depth_m = 0.6F;
  follow(2);
  EXPECT_GE(4 * right(), 3 * started);
}

TEST_F(SeedDepth, StaysUnknownUnderPureRotation) {
  start();
  for (int k = 1; k <= 8; ++k) {
    const Rigid<double> T{rotation_exp(Vector3<double>(0, 0.01 * k, 0)), {0, 0, 0}};
    const auto image = scene_.render(camera_, T);
    pool_.follow(test::view(image, camera_), test::to_float(camera_), test::to_float(T),
                 parameters_, unlimited_);
    ConvergedSeed converged;
    EXPECT_FALSE(pool_.take_converged(test::to_float(camera_), parameters_, converged));
  }
  EXPECT_GE(pool_.size(), 4);
}

/// An error of the caller's heading looks like parallax: it must not end up in the depths.
TEST_F(SeedDepth, IsSeparatedFromAnUnreportedTurn) {
  start();
  int landmarks = 0;
  parameters_.sigma_yaw_rad = 0.006F;
  for (int k = 1; k <= 14; ++k) {
    const Rigid<double> T{Quaternion<double>::Identity(), {0.04 * k, 0, 0}};
    const double turn = 0.005 * ((k % 3) - 1) + 0.001 * k;
    const Rigid<double> reported{rotation_exp(Vector3<double>(0, turn, 0)), T.translation};
    const auto image = scene_.render(camera_, T);
    pool_.follow(test::view(image, camera_), test::to_float(camera_), test::to_float(reported),
                 parameters_, unlimited_);
    ConvergedSeed converged;
    while (pool_.take_converged(test::to_float(camera_), parameters_, converged)) {
      ++landmarks;
      EXPECT_NEAR(converged.depth_m, kDepth, 3.0 * static_cast<double>(converged.sigma_depth_m));
    }
  }
  EXPECT_GE(landmarks, 3);
}

/// A car's pitch from one frame to the next moves the picture by several pixels.
TEST_F(SeedDepth, IsFoundWhileTheCameraPitches) {
  start();
  const int started = pool_.size();
  int landmarks = 0;
  int followed = 0;
  int found = 0;
  parameters_.sigma_pitch_rad = 0.012F;
  parameters_.search.gate = parameters_.gate = 18.42F;
  for (int k = 1; k <= 10; ++k) {
    const double pitch = k % 2 == 0 ? 0.006 : -0.006;
    const Rigid<double> reported{Quaternion<double>::Identity(), {0.05 * k, 0, 0}};
    const Rigid<double> T{rotation_exp(Vector3<double>(pitch, 0, 0)), reported.translation};
    const auto image = scene_.render(camera_, T);
    pool_.follow(test::view(image, camera_), test::to_float(camera_), test::to_float(reported),
                 parameters_, unlimited_);
    followed += k <= 4 ? pool_.size() : 0;
    found += k <= 4 ? pool_.found() : 0;
    ConvergedSeed converged;
    while (pool_.take_converged(test::to_float(camera_), parameters_, converged)) {
      ++landmarks;
      EXPECT_NEAR(converged.depth_m, kDepth, 3.0 * static_cast<double>(converged.sigma_depth_m));
    }
  }
  // The plane's squares have look-alike corners within the window that the pitch needs.
  EXPECT_GE(10 * found, 7 * followed) << found << " of " << followed;
  EXPECT_GE(landmarks * 2, started);
}

/// The caller's roll is not estimated, but known to be uncertain.
TEST_F(SeedDepth, AllowsForAnUncertainRoll) {
  start();
  parameters_.sigma_roll_rad = 0.02F;
  parameters_.search.gate = 18.42F;
  const Rigid<double> T{rotation_exp(Vector3<double>(0, 0, 0.03)), {0, 0, 0}};
  const auto image = scene_.render(camera_, T);
  pool_.follow(test::view(image, camera_), test::to_float(camera_), Rigid<float>{}, parameters_,
               unlimited_);
  EXPECT_GE(10 * pool_.found(), 8 * pool_.size());
}

TEST_F(SeedDepth, IsNotLostForAFrameThatCannotPayForItsSearch) {
  start();
  const int started = pool_.size();
  const auto image = scene_.render(camera_, Rigid<double>{});
  for (int k = 0; k < 6; ++k) {
    WorkBudget little(pool_.work_to_follow());
    EXPECT_EQ(pool_.follow(test::view(image, camera_), test::to_float(camera_), Rigid<float>{},
                           parameters_, little),
              0);
    EXPECT_GE(little.left(), 0);
  }
  EXPECT_EQ(pool_.size(), started);
}

TEST_F(SeedDepth, IsForgottenWithItsKeyframe) {
  start();
  const int started = pool_.size();
  EXPECT_EQ(pool_.end_keyframes(true), 0) << "there is room for three more";
  for (LandmarkId id = 8; id < 11; ++id) ASSERT_TRUE(ok(pool_.begin_keyframe(id)));
  EXPECT_EQ(pool_.begin_keyframe(11), Status::kFull);
  EXPECT_EQ(pool_.end_keyframes(false), 0);
  EXPECT_FALSE(pool_.has_keyframe(8)) << "nothing began there";
  EXPECT_TRUE(pool_.has_keyframe(kKeyframe));
  EXPECT_EQ(pool_.size(), started);
}

TEST_F(SeedDepth, LostSeedsAreDropped) {
  start();
  const auto other = PlaneScene(kDepth, 0.11, 77).render(camera_, Rigid<double>{});
  const int started = pool_.size();
  int dropped = 0;
  for (int k = 0; k < 4; ++k) {
    dropped += pool_.follow(test::view(other, camera_), test::to_float(camera_), Rigid<float>{},
                            parameters_, unlimited_);
  }
  // One in ten may look alike by chance: what they are not is lost in silence.
  EXPECT_EQ(dropped + pool_.size(), started);
  EXPECT_LE(pool_.size() * 10, started);
}

}  // namespace
}  // namespace cairn
