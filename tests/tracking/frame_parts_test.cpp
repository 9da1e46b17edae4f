#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/tracking/frame_input.hpp"
#include "cairn/tracking/frame_work.hpp"
#include "cairn/tracking/motion_noise.hpp"
#include "cairn/tracking/stage_timer.hpp"
#include "cairn/tracking/start_trial.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

class InputOfFrames : public ::testing::Test {
 protected:
  Status check(std::int64_t t_us, int width = 320) {
    return input_.check({pixels_.data(), width, 240, 320}, camera_, t_us, clock_, health_);
  }
  FrameStep frame(std::int64_t t_us) {
    EXPECT_EQ(check(t_us), Status::kOk);
    return input_.accept(t_us, health_);
  }
  void reset() {
    input_.reset(kMaxStepUs);
    clock_.reset(kMaxStepUs);
  }

  static constexpr std::int64_t kMaxStepUs = 1000000;
  static constexpr std::int64_t kPeriodUs = 33000;

  const PinholeCamera<float> camera_ = test::to_float(test::small_camera());
  std::vector<std::uint8_t> pixels_ = std::vector<std::uint8_t>(320 * 240, 90);
  FrameInput input_;
  InputClock clock_;
  Health health_;
};

TEST_F(InputOfFrames, AcceptsThemInTheOrderOfTime) {
  EXPECT_EQ(check(0), Status::kNotInitialised);
  reset();
  EXPECT_EQ(frame(1000).us, 0) << "nothing before the first";
  EXPECT_EQ(check(1000), Status::kDuplicate);
  EXPECT_EQ(check(999), Status::kTimeBackwards);
  EXPECT_EQ(health_.time_errors, 2U);
  const FrameStep step = frame(34000);
  EXPECT_EQ(step.us, 33000);
  EXPECT_EQ(step.missed, 0);
  EXPECT_FALSE(step.gap);
}

TEST_F(InputOfFrames, CountsThoseThatDidNotCome) {
  reset();
  std::int64_t now = 0;
  for (int k = 0; k < 20; ++k) frame(now += kPeriodUs + (k % 2 == 0 ? 5000 : -5000));
  EXPECT_EQ(health_.frame_gaps, 0U) << "a clock that jitters misses none";
  EXPECT_EQ(frame(now += 2 * kPeriodUs).missed, 1);
  EXPECT_NEAR(frame(now += 20 * kPeriodUs).missed, 19, 2);
  EXPECT_FALSE(frame(now += kPeriodUs).gap);
  EXPECT_NEAR(health_.frame_gaps, 20, 2);
}

TEST_F(InputOfFrames, TakesAnotherRateForTheCamerasAfterAWhile) {
  reset();
  std::int64_t now = 0;
  for (int k = 0; k < 10; ++k) frame(now += kPeriodUs);
  for (int k = 0; k < 20; ++k) frame(now += 3 * kPeriodUs);
  EXPECT_EQ(frame(now += 3 * kPeriodUs).missed, 0);
}

TEST_F(InputOfFrames, GoesOnAfterAGapOnceTheClockIsBelieved) {
  reset();
  std::int64_t now = 0;
  for (int k = 0; k < 10; ++k) frame(now += kPeriodUs);
  now += 4 * kMaxStepUs;
  EXPECT_EQ(check(now), Status::kTimeGap);
  EXPECT_EQ(health_.time_errors, 1U);
  const FrameStep step = frame(now += kPeriodUs);
  EXPECT_TRUE(step.gap);
  EXPECT_EQ(step.us, kMaxStepUs);
  EXPECT_NEAR(step.missed, 121, 3);
}

TEST_F(InputOfFrames, GoesOnWhenTheClockWasSetBack) {
  reset();
  std::int64_t now = 3600000000;
  for (int k = 0; k < 10; ++k) frame(now += kPeriodUs);
  EXPECT_EQ(check(0), Status::kTimeBackwards);
  const FrameStep step = frame(kPeriodUs);
  EXPECT_TRUE(step.gap) << "of unknown length";
  EXPECT_EQ(step.us, kMaxStepUs);
  EXPECT_EQ(frame(2 * kPeriodUs).us, kPeriodUs);
}

/// Stamps from outside may lie anywhere in their type.
TEST_F(InputOfFrames, LivesWithTheEndsOfTime) {
  reset();
  constexpr std::int64_t kFirst = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kLast = std::numeric_limits<std::int64_t>::max();
  frame(kFirst);
  frame(kFirst + kPeriodUs);
  EXPECT_EQ(check(kLast - kPeriodUs), Status::kTimeGap);
  const FrameStep step = frame(kLast);
  EXPECT_TRUE(step.gap);
  EXPECT_EQ(step.missed, 1000000);
}

TEST_F(InputOfFrames, RefusesAnotherSize) {
  reset();
  EXPECT_EQ(check(0, 319), Status::kInvalidArgument);
  EXPECT_EQ(health_.images_refused, 1U);
  EXPECT_EQ(FrameInput::check_camera(camera_, 320, 240), Status::kOk);
  EXPECT_EQ(FrameInput::check_camera(camera_, 319, 240), Status::kBadConfig);
  EXPECT_EQ(FrameInput::check_camera(PinholeCamera<float>{}, 320, 240), Status::kBadConfig);
}

class WorkOfFrames : public ::testing::Test {
 protected:
  WorkOfFrames() { work_.reset(1000, 2); }
  void end(int deferred = 0) { work_.end(deferred, report_, health_); }

  FrameWork work_;
  FrameReport report_;
  Health health_;
};

TEST_F(WorkOfFrames, ReportsTheLargestCut) {
  work_.begin(100);
  work_.raise_cut(FrameCut::kFewerUpdates);
  work_.cut_mapping();
  EXPECT_TRUE(work_.take(900));
  EXPECT_FALSE(work_.take(1));
  end(3);
  EXPECT_EQ(report_.cut, FrameCut::kNoMapping);
  EXPECT_EQ(report_.deferred, 3);
  EXPECT_EQ(report_.work, 1000);
  EXPECT_EQ(health_.budget_exceeded, 1U);
  EXPECT_EQ(health_.searches_deferred, 3U);
  work_.begin(100);
  end();
  EXPECT_EQ(report_.cut, FrameCut::kNone);
  EXPECT_EQ(health_.budget_exceeded, 1U);
}

TEST_F(WorkOfFrames, KeepsHalfForAMapThatHasWaited) {
  work_.begin(0);
  EXPECT_EQ(work_.for_searches(100, 300), 600);
  EXPECT_EQ(work_.for_searches(100, 800), 450) << "some searches, some updates";
  for (int k = 0; k < 2; ++k) {
    work_.begin(0);
    work_.cut_mapping();
    end();
  }
  work_.begin(0);
  EXPECT_EQ(work_.for_searches(100, 100), 300);
}

TEST_F(WorkOfFrames, KnowsAFrameThatCouldNotSearch) {
  work_.begin(0);
  work_.set_search_cut(FrameCut::kPredictionOnly);
  EXPECT_FALSE(work_.could_search());
  work_.begin(0);
  EXPECT_TRUE(work_.could_search());
}

std::uint32_t next_tick(void* context) {
  auto& ticks = *static_cast<std::uint32_t*>(context);
  return ticks += 10;
}

TEST(StageTimer, AddsUpTheStages) {
  std::uint32_t ticks = 0xFFFFFFF8U;  // they wrap
  const TickSource source{&next_tick, &ticks};
  FrameReport report;
  StageTimer timer(source, report);
  timer.end(Stage::kPreprocess);
  timer.end(Stage::kFeatures);
  timer.end(Stage::kFeatures);
  EXPECT_EQ(report.stage_ticks[static_cast<int>(Stage::kPreprocess)], 10U);
  EXPECT_EQ(report.stage_ticks[static_cast<int>(Stage::kFeatures)], 20U);
}

/// GIVEN a start on trial for two blocks of three frames.
class Trial : public ::testing::Test {
 protected:
  Trial() {
    StartTrial::Parameters parameters;
    parameters.blocks = 2;
    parameters.block_frames = 3;
    parameters.max_restarts = 1;
    parameters.max_misfit = 1.3F;
    trial_.reset(parameters);
  }
  /// Frames with ten matches, of which `inliers` agree with innovations of `nis` together.
  bool frames(int count, int inliers, float nis) {
    MeasurementCounts counts;
    counts.matches = 10;
    counts.inliers = inliers;
    counts.nis = nis;
    bool failed = false;
    for (int k = 0; k < count; ++k) failed = trial_.fails(counts, 9.0F);
    return failed;
  }
  StartTrial trial_;
};

TEST_F(Trial, PassesWhereInnovationsAgreeWithTheirCovariance) {
  EXPECT_FALSE(frames(6, 10, 20.0F));
  EXPECT_TRUE(trial_.over());
  EXPECT_FALSE(frames(6, 10, 200.0F)) << "the trial is over";
}

TEST_F(Trial, FailsAtTheEndOfABlock) {
  EXPECT_FALSE(frames(2, 10, 40.0F));
  EXPECT_TRUE(frames(1, 10, 40.0F));
}

TEST_F(Trial, CountsRefusedMatchesWithTheGate) {
  EXPECT_FALSE(frames(3, 9, 16.0F)) << "25 of 26";
  EXPECT_TRUE(frames(3, 8, 16.0F)) << "34 of 26";
}

TEST_F(Trial, RestartsNoMoreThanItMay) {
  trial_.note_restart();
  EXPECT_FALSE(frames(3, 10, 100.0F)) << "there is no further restart";
}

TEST(MotionNoiseOfHands, RisesAtOnceWithAChangeAndFallsSlowly) {
  MotionNoise noise;
  const MotionNoise::Parameters parameters;
  noise.reset(parameters);
  EXPECT_EQ(noise.velocity_noise(), parameters.least_velocity_noise);
  EXPECT_EQ(noise.rate_noise(), parameters.least_rate_noise);
  constexpr float kStep_s = 0.04F;
  noise.note(Vector3<float>::Zero(), Vector3<float>(2, 0, 0), kStep_s);
  EXPECT_EQ(noise.rate_noise(), parameters.least_rate_noise) << "a first rate is no change";
  noise.note(Vector3<float>::Zero(), Vector3<float>(2, 0.6F, 0), kStep_s);
  const float risen = noise.rate_noise();
  EXPECT_NEAR(risen, 0.6F / std::sqrt(3.0F * kStep_s), 1e-4F);
  EXPECT_EQ(noise.velocity_noise(), parameters.least_velocity_noise);
  noise.note(Vector3<float>::Zero(), Vector3<float>(2, 0.6F, 0), kStep_s);
  EXPECT_NEAR(noise.rate_noise(), risen * std::sqrt(parameters.memory), 1e-4F);
}

TEST(MotionNoiseOfHands, GrowsWithEveryWeakFrameUpToItsLimit) {
  MotionNoise noise;
  const MotionNoise::Parameters parameters;
  noise.reset(parameters);
  noise.note_weak();
  EXPECT_NEAR(noise.rate_noise(), parameters.weak_growth * parameters.least_rate_noise, 1e-5F);
  for (int k = 0; k < 20; ++k) noise.note_weak();
  EXPECT_EQ(noise.rate_noise(), parameters.most_rate_noise);
  EXPECT_EQ(noise.velocity_noise(), parameters.most_velocity_noise);
  noise.begin();
  EXPECT_EQ(noise.rate_noise(), parameters.least_rate_noise);
}

}  // namespace
}  // namespace cairn
