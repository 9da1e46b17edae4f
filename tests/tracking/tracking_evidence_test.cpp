#include "cairn/tracking/tracking_evidence.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

/// GIVEN a vehicle that has tracked for a while: 30 of 40 landmarks looked for are inliers.
class AVehicleThatTracks : public ::testing::Test {
 protected:
  AVehicleThatTracks() {
    evidence_.reset({});
    for (int k = 0; k < 100; ++k) judge(40, 32, 30);
  }
  FrameReport frame(int searched, int matches, int inliers = 0) const {
    FrameReport report;
    report.status = Status::kOk;
    report.searched = searched;
    report.matches = matches;
    report.inliers = inliers;
    return report;
  }
  FrameReport judge(int searched, int matches, int inliers) {
    FrameReport report = frame(searched, matches, inliers);
    evidence_.judge(report, health_);
    return report;
  }

  TrackingEvidence evidence_;
  Health health_;
};

TEST_F(AVehicleThatTracks, TakesFewOfManyForChance) {
  EXPECT_EQ(evidence_.state(), TrackingState::kTracking);
  EXPECT_FALSE(evidence_.worth_an_update(frame(40, 3), 3));
  EXPECT_TRUE(evidence_.worth_an_update(frame(40, 4), 4));
}

TEST_F(AVehicleThatTracks, WantsMoreWhenItComesBack) {
  judge(40, 0, 0);
  EXPECT_TRUE(evidence_.worth_an_update(frame(40, 4), 4));
  judge(40, 0, 0);
  EXPECT_FALSE(evidence_.worth_an_update(frame(40, 11), 11));
  EXPECT_TRUE(evidence_.worth_an_update(frame(40, 12), 12));
  EXPECT_FALSE(evidence_.worth_an_update(frame(10, 5), 5));
  EXPECT_TRUE(evidence_.worth_an_update(frame(10, 6), 6));
}

TEST_F(AVehicleThatTracks, WantsHalfOfTheUsualOrNearlyAllOfThoseFound) {
  EXPECT_EQ(evidence_.support_wanted(frame(40, 30), 2), 15);
  EXPECT_EQ(evidence_.support_wanted(frame(40, 10), 2), 8);
  EXPECT_EQ(evidence_.support_wanted(frame(40, 2), 2), 4);
  EXPECT_EQ(evidence_.support_wanted(frame(40, 30), 20), 20);
  evidence_.forget_usual();
  EXPECT_EQ(evidence_.support_wanted(frame(40, 30), 2), 2);
}

TEST_F(AVehicleThatTracks, IsLostAfterSixtyWeakFramesAndOnce) {
  for (int k = 0; k < 60; ++k) {
    EXPECT_EQ(judge(40, 3, 3).state, TrackingState::kUncertain);
  }
  const FrameReport lost = judge(40, 3, 3);
  EXPECT_EQ(lost.state, TrackingState::kLost);
  EXPECT_EQ(lost.status, Status::kLost);
  judge(40, 3, 3);
  EXPECT_EQ(health_.losses, 1U);
  EXPECT_EQ(health_.low_texture_frames, 62U);
  EXPECT_EQ(judge(40, 20, 4).state, TrackingState::kTracking);
  EXPECT_EQ(evidence_.weak_frames(), 0);
}

TEST_F(AVehicleThatTracks, CountsNoFrameThatDidNotLook) {
  FrameReport report = frame(0, 0);
  report.cut = FrameCut::kPredictionOnly;
  for (int k = 0; k < 100; ++k) evidence_.judge(report, health_);
  EXPECT_EQ(evidence_.state(), TrackingState::kUncertain);
  EXPECT_EQ(evidence_.weak_frames(), 0);
}

TEST_F(AVehicleThatTracks, KnowsAPlaceBySevenTenthsOfIt) {
  EXPECT_FALSE(evidence_.tells_place(13, 20));
  EXPECT_TRUE(evidence_.tells_place(14, 20));
  EXPECT_FALSE(evidence_.tells_place(5, 5));
  EXPECT_EQ(evidence_.support_of_place(14), 10);
  EXPECT_EQ(evidence_.support_of_place(7), 6);
}

TEST(TrackingEvidence, StaysInitialisingUntilSomethingFits) {
  TrackingEvidence evidence;
  evidence.reset({});
  Health health;
  FrameReport report;
  for (int k = 0; k < 200; ++k) evidence.judge(report, health);
  EXPECT_EQ(evidence.state(), TrackingState::kInitialising);
  EXPECT_EQ(health.losses, 0U);
  report.inliers = 4;
  evidence.judge(report, health);
  EXPECT_EQ(evidence.state(), TrackingState::kTracking);
}

}  // namespace
}  // namespace cairn
