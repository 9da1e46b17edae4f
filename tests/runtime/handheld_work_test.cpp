#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/runtime/handheld_tracker.hpp"
#include "cairn/runtime/replay.hpp"

#include "frame_reports.hpp"
#include "two_walls.hpp"

namespace cairn {
namespace {

using Handheld = HandheldTracker<DefaultConfig>;

/// GIVEN a hand-held camera that moves before two textured planes.
class HandheldWithAWorkLimit : public ::testing::Test {
 protected:
  static constexpr int kWarm = 60;
  static constexpr std::int64_t kStepUs = 33333;

  HandheldWithAWorkLimit() {
    Handheld::Parameters parameters;
    parameters.start.blocks = 3;
    own_limit_ = parameters.work_limit;
    EXPECT_TRUE(ok(tracker_->initialise(test::to_float(test::small_camera()), parameters)));
    move(kWarm, own_limit_);
  }

  void move(int frames, int limit) {
    EXPECT_TRUE(ok(tracker_->set_work_limit(limit)));
    reports_.clear();
    for (int k = 0; k < frames; ++k) show(test::two_walls(frame_));
  }
  void show(const std::vector<std::uint8_t>& image) {
    FrameReport report;
    static_cast<void>(tracker_->process_frame(test::view(image, test::small_camera()),
                                              frame_ * kStepUs, TickSource{}, report));
    reports_.push_back(report);
    ++frame_;
  }

  int count(FrameCut cut) const { return test::count_cut(reports_, cut); }
  int most_work() const { return test::most_work(reports_); }
  int usual_inliers() const { return reports_.back().inliers; }

  std::unique_ptr<Handheld> tracker_ = std::make_unique<Handheld>();
  std::vector<FrameReport> reports_;
  int own_limit_ = 0;
  int frame_ = 0;
};

TEST_F(HandheldWithAWorkLimit, GivesNothingUpUnderItsOwnLimit) {
  EXPECT_EQ(count(FrameCut::kNone), kWarm);
  EXPECT_EQ(tracker_->health().budget_exceeded, 0U);
  EXPECT_LE(most_work(), own_limit_);
  EXPECT_EQ(reports_.back().state, TrackingState::kTracking);
}

/// The rungs of the ladder: fewer updates, then nothing but prediction; a pose every frame, and no
/// frame above its limit.
TEST_F(HandheldWithAWorkLimit, StepsDownTheLadderAsTheLimitShrinks) {
  const int usual = usual_inliers();
  ASSERT_GE(usual, 20);

  move(6, 2500);
  EXPECT_LE(most_work(), 2500);
  EXPECT_EQ(count(FrameCut::kNone) + count(FrameCut::kPredictionOnly), 0);
  EXPECT_GE(usual_inliers(), Handheld::Parameters{}.monitor.min_inliers);
  EXPECT_LT(usual_inliers(), usual);
  EXPECT_EQ(reports_.back().state, TrackingState::kTracking);

  move(6, 320);  // what every frame does takes 312
  EXPECT_LE(most_work(), 320);
  EXPECT_EQ(count(FrameCut::kPredictionOnly), 6);
  EXPECT_EQ(reports_.back().inliers, 0);
  EXPECT_EQ(reports_.back().state, TrackingState::kUncertain);
  EXPECT_GE(tracker_->health().budget_exceeded, 12U);
}

/// Half a second without any work but prediction: no landmark is removed, and tracking is not lost.
TEST_F(HandheldWithAWorkLimit, TracksAgainWithinFiveFrames) {
  const int landmarks = reports_.back().landmarks;
  move(15, 0);
  EXPECT_EQ(count(FrameCut::kPredictionOnly), 15);
  EXPECT_EQ(tracker_->health().losses, 0U);
  EXPECT_EQ(reports_.back().landmarks, landmarks);
  move(5, own_limit_);
  EXPECT_EQ(reports_.back().state, TrackingState::kTracking);
  EXPECT_GE(usual_inliers(), 20);
}

/// Matching alone would take all of a tight limit for ever, and the camera would leave its map.
TEST_F(HandheldWithAWorkLimit, GoesOnMappingUnderATightLimit) {
  move(40, 3000);
  EXPECT_LE(most_work(), 3000);
  int added = 0;
  for (const FrameReport& report : reports_) added += report.added;
  EXPECT_GT(added, 0);
  EXPECT_EQ(reports_.back().state, TrackingState::kTracking);
}

/// Noise has a corner everywhere: windows, cells and the relocalisation take the most work.
TEST_F(HandheldWithAWorkLimit, StaysWithinItInNoiseAndWhileLost) {
  Random random(3);
  std::vector<std::uint8_t> noise(test::two_walls(0).size());
  reports_.clear();
  for (int k = 0; k < 60; ++k) {
    for (std::uint8_t& grey : noise) grey = static_cast<std::uint8_t>(random.next() >> 24);
    show(noise);
  }
  EXPECT_EQ(reports_.back().state, TrackingState::kLost);
  EXPECT_LE(most_work(), own_limit_);
}

TEST_F(HandheldWithAWorkLimit, RefusesANegativeLimit) {
  EXPECT_EQ(tracker_->set_work_limit(-1), Status::kInvalidArgument);
  reports_.clear();
  show(test::two_walls(frame_));
  EXPECT_EQ(count(FrameCut::kNone), 1);
}

}  // namespace
}  // namespace cairn
