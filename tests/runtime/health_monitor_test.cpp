#include "cairn/runtime/health_monitor.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr std::int64_t kFrame_us = 33333;
constexpr int kFramesInTwoSeconds = 60;

/// Frames of a camera at 30 Hz that the tracker takes, with what the test changes in them.
class HealthMonitorTest : public ::testing::Test {
 protected:
  HealthMonitorTest() {
    EXPECT_EQ(monitor_.reset(HealthLimits{}), Status::kOk);
    report_.state = TrackingState::kTracking;
    report_.status = Status::kOk;
    report_.matches = 20;
    report_.inliers = 18;
    report_.update.nis = 36.0F;
    report_.update.nis_dof = 36;
    sigma_.position_m = 0.1F;
    sigma_.heading_rad = 0.01F;
  }

  void frames(int n) {
    for (int i = 0; i < n; ++i) {
      t_us_ += kFrame_us;
      report_.t_us = t_us_;
      monitor_.note(t_us_, report_.status, report_, health_, sigma_);
    }
  }
  void refused(int n) {
    for (int i = 0; i < n; ++i) {
      ++health_.images_refused;
      monitor_.note(t_us_ + kFrame_us, Status::kInvalidArgument, report_, health_, sigma_);
    }
  }

  HealthMonitor monitor_;
  FrameReport report_;
  Health health_;
  PoseSigma sigma_;
  std::int64_t t_us_ = 0;
};

TEST_F(HealthMonitorTest, IsUnhealthyUntilAFrameTracks) {
  EXPECT_FALSE(monitor_.healthy());
  report_.state = TrackingState::kInitialising;
  frames(1);
  EXPECT_FALSE(monitor_.healthy());
  report_.state = TrackingState::kTracking;
  frames(1);
  EXPECT_TRUE(monitor_.healthy());
}

TEST_F(HealthMonitorTest, ImpossibleLimitsAreRefusedAndNothingChanges) {
  frames(kFramesInTwoSeconds);
  HealthLimits limits;
  limits.max_blind_s = 0.0F;
  EXPECT_EQ(monitor_.reset(limits), Status::kBadConfig);
  limits.max_blind_s = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(monitor_.reset(limits), Status::kBadConfig);
  EXPECT_TRUE(monitor_.healthy());
}

TEST_F(HealthMonitorTest, BlindTimeCountsFromTheLastFrameThatTracked) {
  frames(kFramesInTwoSeconds);
  report_.state = TrackingState::kUncertain;
  frames(14);
  EXPECT_TRUE(monitor_.healthy());
  EXPECT_NEAR(monitor_.blind_s(), 14 * 33.333e-3F, 1e-4F);
  frames(2);
  EXPECT_FALSE(monitor_.healthy());
  report_.state = TrackingState::kTracking;
  frames(1);
  EXPECT_TRUE(monitor_.healthy());
}

TEST_F(HealthMonitorTest, SigmasBeyondTheLimitsAreUnhealthy) {
  frames(kFramesInTwoSeconds);
  sigma_.position_m = 0.6F;
  frames(1);
  EXPECT_FLOAT_EQ(monitor_.score(), 1.2F);
  sigma_.position_m = 0.1F;
  sigma_.heading_rad = 0.2F;
  frames(1);
  EXPECT_FLOAT_EQ(monitor_.score(), 2.0F);
}

TEST_F(HealthMonitorTest, ACovarianceThatIsNoneIsUnhealthy) {
  frames(kFramesInTwoSeconds);
  Matrix3<float> covariance = Matrix3<float>::Identity() * 1e-4F;
  covariance(2, 2) = -1e-6F;
  sigma_ = pose_sigma(covariance);
  frames(1);
  EXPECT_FALSE(monitor_.healthy());
  sigma_ = pose_sigma(Matrix3<float>::Identity() * 1e-4F);
  frames(1);
  EXPECT_TRUE(monitor_.healthy());
}

TEST_F(HealthMonitorTest, NisOfTheModelIsHealthyAndTwiceItOverASecondIsNot) {
  frames(kFramesInTwoSeconds);
  EXPECT_NEAR(monitor_.nis_ratio(), 1.0F, 1e-4F);
  EXPECT_LT(monitor_.nis_test_ratio(), 1.0F);
  report_.update.nis = 72.0F;
  frames(kFramesInTwoSeconds);
  EXPECT_GT(monitor_.nis_ratio(), 1.5F);
  EXPECT_FALSE(monitor_.healthy());
}

/// 99.99 % quantiles of chi-square: 18.42 for 2 degrees of freedom, 82.06 for 40.
TEST_F(HealthMonitorTest, BoundOfNisIsChiSquaresQuantile) {
  report_.update.nis = 18.42F;
  report_.update.nis_dof = 2;
  frames(1);
  EXPECT_NEAR(monitor_.nis_test_ratio(), 1.0F, 0.05F);
  EXPECT_EQ(monitor_.reset(HealthLimits{}), Status::kOk);
  report_.update.nis = 82.06F;
  report_.update.nis_dof = 40;
  frames(1);
  EXPECT_NEAR(monitor_.nis_test_ratio(), 1.0F, 0.01F);
}

TEST_F(HealthMonitorTest, MostMatchesOutliersIsUnhealthy) {
  frames(kFramesInTwoSeconds);
  EXPECT_NEAR(monitor_.outlier_share(), 0.1F, 1e-4F);
  report_.inliers = 4;
  frames(kFramesInTwoSeconds);
  EXPECT_FALSE(monitor_.healthy());
}

TEST_F(HealthMonitorTest, ARepairedFilterIsUnhealthyForOneWindow) {
  frames(kFramesInTwoSeconds);
  ++health_.covariance_repairs;
  frames(1);
  EXPECT_FALSE(monitor_.healthy());
  frames(29);
  EXPECT_FALSE(monitor_.healthy());
  frames(2);
  EXPECT_TRUE(monitor_.healthy());
}

TEST_F(HealthMonitorTest, OneRefusedFrameIsHealthyAndManyAreNot) {
  frames(kFramesInTwoSeconds);
  refused(1);
  EXPECT_TRUE(monitor_.healthy());
  refused(16);
  EXPECT_FALSE(monitor_.healthy());
  frames(kFramesInTwoSeconds);
  EXPECT_TRUE(monitor_.healthy());
}

TEST_F(HealthMonitorTest, EventsAreListedNewestFirstAndRunsAreOneEntry) {
  frames(3);
  refused(4);
  const std::int64_t first_refusal_us = t_us_ + kFrame_us;
  ++health_.losses;
  frames(2);
  ASSERT_EQ(monitor_.record_count(), 2);
  EXPECT_EQ(monitor_.record(0).event, HealthEvent::kLoss);
  EXPECT_EQ(monitor_.record(1).event, HealthEvent::kImageRefused);
  EXPECT_EQ(monitor_.record(1).count, 4U);
  EXPECT_EQ(monitor_.record(1).t_us, first_refusal_us);
}

TEST_F(HealthMonitorTest, TheListKeepsTheLastSixteen) {
  for (int i = 0; i < 20; ++i) {
    ++(i % 2 == 0 ? health_.time_errors : health_.frame_gaps);
    frames(1);
  }
  ASSERT_EQ(monitor_.record_count(), HealthMonitor::kRecords);
  EXPECT_EQ(monitor_.record(0).t_us, t_us_);
  EXPECT_EQ(monitor_.record(15).t_us, t_us_ - 15 * kFrame_us);
}

TEST_F(HealthMonitorTest, EveryEventHasAName) {
  for (int i = 0; i < kHealthEventCount; ++i) {
    EXPECT_GT(to_string(static_cast<HealthEvent>(i))[0], '\0');
  }
}

}  // namespace
}  // namespace cairn
