#include <cmath>

#include <gtest/gtest.h>

#include "cairn/tracking/fixed_seed_odometry.hpp"
#include "cairn/tracking/seed_pool.hpp"
#include "cairn/vision/fast.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

using FixedPool = SeedPool<16, 4, FixedSeedOdometry<16, 4>>;
using Pool = SeedPool<16, 4>;
using test::PlaneScene;

/// GIVEN the same seeds on a plane 3 m ahead in a pool in float and in one in fixed point.
class FixedSeedDepth : public ::testing::Test {
 protected:
  static constexpr double kDepth = 3.0;
  static constexpr LandmarkId kKeyframe = 7;

  void SetUp() override {
    lens_ = test::to_float(camera_);
    parameters_.off_path = 0.01F;
  }

  static FixedRigid fixed(const Rigid<float>& T) {
    std::uint32_t lost = 0;
    return fixed_rigid_of(T, lost);
  }
  void follow(const Rigid<double>& T, const Rigid<double>& reported) {
    const auto image = scene_.render(camera_, T);
    const Rigid<float> told = test::to_float(reported);
    pool_.follow(test::view(image, camera_), lens_, told, parameters_, unlimited_);
    own_.follow(test::view(image, camera_), lens_, fixed(told), parameters_, unlimited_);
  }
  void start() {
    const auto image = scene_.render(camera_, Rigid<double>{});
    FastScratch<320> scratch;
    Corner corners[64];
    FastReport report;
    ASSERT_TRUE(ok(detect_fast(test::view(image, camera_), {60, 60, 260, 180}, 40, scratch, corners,
                               64, report)));
    follow({}, {});
    begin(image, corners, report.found - report.dropped, pool_);
    begin(image, corners, report.found - report.dropped, own_);
    ASSERT_GE(own_.size(), 5);
    ASSERT_EQ(own_.size(), pool_.size());
  }
  template <class Image, class AnyPool>
  void begin(const Image& image, const Corner* corners, int count, AnyPool& pool) {
    ASSERT_TRUE(ok(pool.begin_keyframe(kKeyframe)));
    for (int i = 0; i < count && !pool.full(); i += 3) {
      static_cast<void>(pool.add(test::view(image, camera_), lens_, corners[i].x, corners[i].y,
                                 kKeyframe, parameters_));
    }
  }
  /// Seeds found alike, at depths within a hundredth of the first deviation.
  void expect_alike() {
    ASSERT_EQ(own_.size(), pool_.size());
    for (int i = 0; i < own_.size(); ++i) {
      EXPECT_EQ(own_[i].seen, pool_[i].seen) << i;
      EXPECT_NEAR(own_[i].rho, pool_[i].rho, 0.01F * parameters_.initial_sigma_rho) << i;
      EXPECT_NEAR(own_[i].pixel.x(), pool_[i].pixel.x(), 0.02F) << i;
    }
  }
  void expect_turned_alike() {
    Quaternion<float> turn;
    Quaternion<float> own_turn;
    float variance = 0.0F;
    float own_variance = 0.0F;
    ASSERT_TRUE(pool_.turn_since(kKeyframe, turn, variance));
    ASSERT_TRUE(own_.turn_since(kKeyframe, own_turn, own_variance));
    EXPECT_LT(own_turn.angularDistance(turn), 1e-4F);
    EXPECT_NEAR(own_variance, variance, 0.01F * variance + 1e-10F);
  }
  /// Takes those that have converged out of both; returns how many.
  int take_alike() {
    int taken = 0;
    ConvergedSeed seed;
    ConvergedSeed own;
    while (own_.take_converged(lens_, parameters_, own)) {
      ++taken;
      EXPECT_TRUE(pool_.take_converged(lens_, parameters_, seed));
      EXPECT_NEAR(own.depth_m, seed.depth_m, 0.02F * seed.sigma_depth_m);
      EXPECT_NEAR(own.sigma_depth_m, seed.sigma_depth_m, 0.01F * seed.sigma_depth_m);
      EXPECT_NEAR(own.depth_m, kDepth, 3.0F * own.sigma_depth_m);
      EXPECT_LT((own.T_camera_first.translation - seed.T_camera_first.translation).norm(), 1e-5F);
      EXPECT_LT(
          (own.T_camera_first.rotation.coeffs() - seed.T_camera_first.rotation.coeffs()).norm(),
          1e-4F);
      EXPECT_EQ(own.keyframe, kKeyframe);
    }
    EXPECT_FALSE(pool_.take_converged(lens_, parameters_, seed));
    return taken;
  }

  PinholeCamera<double> camera_ = test::small_camera();
  PinholeCamera<float> lens_;
  PlaneScene scene_{kDepth};
  Pool pool_;
  FixedPool own_;
  WorkBudget unlimited_;
  SeedParameters parameters_;
};

TEST_F(FixedSeedDepth, IsThatOfFloatUnderSidewaysMotion) {
  start();
  const int started = own_.size();
  int landmarks = 0;
  for (int k = 1; k <= 12; ++k) {
    const Rigid<double> T{Quaternion<double>::Identity(), {0.05 * k, 0, 0}};
    follow(T, T);
    expect_alike();
    landmarks += take_alike();
  }
  EXPECT_GE(2 * landmarks, started);
  EXPECT_EQ(own_.saturations(), 0U);
}

TEST_F(FixedSeedDepth, IsThatOfFloatWhereTheReportedTurnIsWrong) {
  start();
  parameters_.sigma_yaw_rad = 0.006F;
  parameters_.sigma_roll_rad = 0.005F;
  int landmarks = 0;
  for (int k = 1; k <= 14; ++k) {
    const double turn = 0.005 * ((k % 3) - 1) + 0.001 * k;
    const Rigid<double> T{rotation_exp(Vector3<double>(0.002 * (k % 2), 0.01 * k, 0.003 * (k % 2))),
                          {0.04 * k, 0, 0.02 * k}};
    const Rigid<double> reported{rotation_exp(Vector3<double>(0, 0.01 * k + turn, 0)),
                                 T.translation};
    follow(T, reported);
    expect_alike();
    expect_turned_alike();
    landmarks += take_alike();
  }
  EXPECT_GE(landmarks, 3);
  EXPECT_EQ(own_.saturations(), 0U);
}

TEST_F(FixedSeedDepth, TellsNoTurnSinceAnotherKeyframe) {
  start();
  Quaternion<float> turn;
  float variance = 0.0F;
  EXPECT_FALSE(own_.turn_since(kKeyframe + 1, turn, variance));
}

/// Only the motion of the poses counts, and not where they are.
TEST_F(FixedSeedDepth, IsTheSameFarFromTheStart) {
  start();
  FixedPool far = own_;
  for (int k = 1; k <= 6; ++k) {
    const Rigid<double> T{Quaternion<double>::Identity(), {0.05 * k, 0, 0}};
    const auto image = scene_.render(camera_, T);
    FixedRigid told = fixed(test::to_float(T));
    own_.follow(test::view(image, camera_), lens_, told, parameters_, unlimited_);
    if (k == 1) continue;
    for (FixedCoordinate& t : told.translation)
      t = FixedCoordinate::from_raw(t.raw() + (1LL << 53));
    far.follow(test::view(image, camera_), lens_, told, parameters_, unlimited_);
  }
  EXPECT_EQ(own_.saturations(), 0U);
  EXPECT_GT(far.saturations(), 0U) << "a jump of a million metres";
}

}  // namespace
}  // namespace cairn
