#include "cairn/tracking/tracking_monitor.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

MeasurementCounts counts(int searched, int matches, int inliers = 0) {
  MeasurementCounts c;
  c.searched = searched;
  c.matches = matches;
  c.inliers = inliers;
  return c;
}

MeasurementCounts without_search() {
  MeasurementCounts none;
  none.could_search = false;
  return none;
}

constexpr float kFrame_s = 0.0333F;

class AMonitor : public ::testing::Test {
 protected:
  void judge(const MeasurementCounts& frame, Status status = Status::kOk) {
    status_ = monitor_.judge(frame, status, health_);
  }

  TrackingMonitor monitor_;
  Status status_ = Status::kOk;
  Health health_;
};

/// GIVEN a vehicle that has tracked for a while: 30 of 40 landmarks searched are inliers.
class AVehicleThatTracks : public AMonitor {
 protected:
  AVehicleThatTracks() {
    monitor_.reset({});
    monitor_.begin_frame(kFrame_s);
    for (int k = 0; k < 100; ++k) judge(counts(40, 32, 30));
  }
};

TEST_F(AVehicleThatTracks, TakesFewOfManyForChance) {
  EXPECT_EQ(monitor_.state(), TrackingState::kTracking);
  EXPECT_FALSE(monitor_.enough_matches(counts(40, 3)));
  EXPECT_TRUE(monitor_.enough_matches(counts(40, 4)));
}

TEST_F(AVehicleThatTracks, SaysWhyAFrameDoesNotDetermineThePose) {
  const NotTracked shortage = NotTracked::kNoDepth;
  EXPECT_EQ(monitor_.why_not_tracked(counts(40, 30, 4), shortage), NotTracked::kTracked);
  EXPECT_EQ(monitor_.why_not_tracked(without_search(), shortage), NotTracked::kNoWork);
  EXPECT_EQ(monitor_.why_not_tracked(counts(3, 3), shortage), shortage);
  EXPECT_EQ(monitor_.why_not_tracked(counts(40, 3), shortage), NotTracked::kNotFound);
  EXPECT_EQ(monitor_.why_not_tracked(counts(80, 5), shortage), NotTracked::kNotFound);
  EXPECT_EQ(monitor_.why_not_tracked(counts(40, 30, 3), shortage), NotTracked::kNoConsensus);
}

TEST_F(AVehicleThatTracks, AsksForMoreMatchesAfterWeakFrames) {
  judge(counts(40, 0));
  EXPECT_TRUE(monitor_.enough_matches(counts(40, 4)));
  judge(counts(40, 0));
  EXPECT_FALSE(monitor_.enough_matches(counts(40, 11)));
  EXPECT_TRUE(monitor_.enough_matches(counts(40, 12)));
  EXPECT_FALSE(monitor_.enough_matches(counts(10, 5)));
  EXPECT_TRUE(monitor_.enough_matches(counts(10, 6)));
  EXPECT_TRUE(monitor_.enough_matches(counts(6, 5))) << "nearly all of a thin map";
  EXPECT_FALSE(monitor_.enough_matches(counts(3, 3)));
}

TEST_F(AVehicleThatTracks, AsksForHalfOfAThinMapAfterWeakFrames) {
  judge(counts(8, 3));
  judge(counts(8, 3));
  EXPECT_FALSE(monitor_.enough_matches(counts(8, 4)));
  EXPECT_TRUE(monitor_.enough_matches(counts(8, 4), true));
  EXPECT_FALSE(monitor_.enough_matches(counts(9, 4), true));
  EXPECT_FALSE(monitor_.enough_matches(counts(6, 3), true));
}

TEST_F(AVehicleThatTracks, IsUncertainAfterFramesThatDidNotComeButNotLost) {
  monitor_.note_blind_frames(1000);
  EXPECT_EQ(monitor_.state(), TrackingState::kUncertain);
  EXPECT_EQ(monitor_.weak_frames(), 1000);
  EXPECT_FALSE(monitor_.enough_matches(counts(40, 11)));
  judge(counts(40, 32, 30));
  EXPECT_EQ(monitor_.state(), TrackingState::kTracking);
  monitor_.note_blind_frames(1000);
  judge(counts(40, 5));
  EXPECT_EQ(monitor_.state(), TrackingState::kLost);
}

TEST_F(AVehicleThatTracks, AsksForHalfOfTheMeanRatioOrNearlyAllMatches) {
  EXPECT_EQ(monitor_.min_inliers(counts(40, 30), 2), 15);
  EXPECT_EQ(monitor_.min_inliers(counts(40, 10), 2), 8);
  EXPECT_EQ(monitor_.min_inliers(counts(40, 2), 2), 4);
  EXPECT_EQ(monitor_.min_inliers(counts(40, 30), 20), 20);
  monitor_.forget_mean();
  EXPECT_EQ(monitor_.min_inliers(counts(40, 30), 2), 2);
}

TEST_F(AVehicleThatTracks, IsLostAfterSixtyWeakFramesAndOnce) {
  for (int k = 0; k < 60; ++k) {
    judge(counts(40, 3, 3));
    EXPECT_EQ(monitor_.state(), TrackingState::kUncertain);
  }
  judge(counts(40, 3, 3));
  EXPECT_EQ(status_, Status::kLost);
  EXPECT_EQ(monitor_.state(), TrackingState::kLost);
  judge(counts(40, 3, 3));
  EXPECT_EQ(health_.losses, 1U);
  EXPECT_EQ(health_.low_texture_frames, 62U);
  judge(counts(40, 20, 4));
  EXPECT_EQ(status_, Status::kOk);
  EXPECT_EQ(monitor_.state(), TrackingState::kTracking);
  EXPECT_EQ(monitor_.weak_frames(), 0);
}

TEST_F(AVehicleThatTracks, IsLostAfterTheSameTimeAtAnyFrameRate) {
  monitor_.begin_frame(0.1F);
  for (int k = 0; k < 19; ++k) {
    judge(counts(40, 3, 3));
    EXPECT_EQ(monitor_.state(), TrackingState::kUncertain);
  }
  for (int k = 0; k < 3; ++k) judge(counts(40, 3, 3));
  EXPECT_EQ(monitor_.state(), TrackingState::kLost);
}

TEST_F(AVehicleThatTracks, CountsNoFrameThatCouldNotSearch) {
  for (int k = 0; k < 100; ++k) judge(without_search());
  EXPECT_EQ(monitor_.state(), TrackingState::kUncertain);
  EXPECT_EQ(monitor_.weak_frames(), 0);
}

TEST_F(AVehicleThatTracks, ConfirmsAPlaceBySevenTenthsOfIt) {
  EXPECT_FALSE(monitor_.confirms_place(13, 20));
  EXPECT_TRUE(monitor_.confirms_place(14, 20));
  EXPECT_FALSE(monitor_.confirms_place(5, 5));
  EXPECT_EQ(monitor_.min_relocalisation_inliers(14), 10);
  EXPECT_EQ(monitor_.min_relocalisation_inliers(7), 6);
}

TEST_F(AVehicleThatTracks, AnErrorOfTheFrameIsItsStatusUnlessLost) {
  judge(counts(40, 32, 30), Status::kTimeGap);
  EXPECT_EQ(status_, Status::kTimeGap);
  judge(counts(40, 3));
  EXPECT_EQ(status_, Status::kLowTexture);
  judge(counts(40, 3), Status::kTimeGap);
  EXPECT_EQ(status_, Status::kTimeGap);
  for (int k = 0; k < 60; ++k) judge(counts(40, 3), Status::kTimeGap);
  EXPECT_EQ(status_, Status::kLost);
}

TEST_F(AMonitor, StaysInitialisingUntilSomethingAgrees) {
  monitor_.reset({});
  for (int k = 0; k < 200; ++k) judge(MeasurementCounts{});
  EXPECT_EQ(monitor_.state(), TrackingState::kInitialising);
  EXPECT_EQ(health_.losses, 0U);
  judge(counts(0, 0, 4));
  EXPECT_EQ(monitor_.state(), TrackingState::kTracking);
}

/// GIVEN a hand-held camera at a place that was recognised a frame ago.
class APlaceOnProbation : public AMonitor {
 protected:
  APlaceOnProbation() {
    TrackingMonitor::Parameters parameters;
    parameters.probation_frames = 10;
    monitor_.reset(parameters);
    monitor_.lose();
    monitor_.begin_probation();
  }
};

TEST_F(APlaceOnProbation, CountsAsFoundOnceItWasFollowed) {
  for (int k = 0; k < 9; ++k) {
    judge(counts(20, 15, 12));
    EXPECT_EQ(monitor_.state(), TrackingState::kUncertain);
  }
  judge(counts(20, 15, 12));
  EXPECT_EQ(monitor_.state(), TrackingState::kTracking);
}

TEST_F(APlaceOnProbation, IsRefusedByOneWeakFrame) {
  judge(without_search());
  EXPECT_EQ(monitor_.state(), TrackingState::kUncertain) << "it could not look";
  judge(counts(20, 3));
  EXPECT_EQ(monitor_.state(), TrackingState::kLost);
  EXPECT_EQ(health_.false_relocalisations_refused, 1U);
  EXPECT_EQ(health_.losses, 0U);
}

}  // namespace
}  // namespace cairn
