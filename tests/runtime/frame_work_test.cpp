#include <cmath>
#include <vector>

#include "cairn/runtime/replay.hpp"

#include "frame_reports.hpp"
#include "vehicle_by_a_wall.hpp"

namespace cairn {
namespace {

constexpr int kOwnLimit = -1;

class VehicleWithAWorkLimit : public test::VehicleByAWall {
 protected:
  static constexpr int kWarm = 40;

  VehicleWithAWorkLimit() : VehicleByAWall(0.02F, 0.02F) {}

  void drive(int frames, int limit) {
    const int own = Vehicle::Parameters{}.work_limit;
    EXPECT_TRUE(ok(tracker_->set_work_limit(limit == kOwnLimit ? own : limit)));
    reports_.clear();
    for (int k = 0; k < frames; ++k) {
      step(picture(frame_), kStep);
      reports_.push_back(report_);
      hash_.add(frame_hash(*tracker_, report_));
    }
  }

  int count(FrameCut cut) const { return test::count_cut(reports_, cut); }
  int most_work() const { return test::most_work(reports_); }
  double position_error() const {
    return std::abs(static_cast<double>(tracker_->filter().mean_pose().position.x()) -
                    (frame_ - 1) * kStep);
  }

  std::vector<FrameReport> reports_;
  Hash64 hash_;
};

TEST_F(VehicleWithAWorkLimit, GivesNothingUpUnderItsOwnLimit) {
  drive(kWarm, kOwnLimit);
  EXPECT_EQ(count(FrameCut::kNone), kWarm);
  EXPECT_EQ(tracker_->health().budget_exceeded, 0U);
  EXPECT_LE(most_work(), Vehicle::Parameters{}.work_limit);
}

/// The rungs of the ladder: fewer updates and no new map, then nothing but odometry; a pose every
/// frame, and no frame above its limit.
TEST_F(VehicleWithAWorkLimit, StepsDownTheLadderAsTheLimitShrinks) {
  drive(kWarm, kOwnLimit);
  const int usual = reports_.back().inliers;
  ASSERT_GE(usual, 12);

  drive(6, 2600);
  EXPECT_LE(most_work(), 2600);
  EXPECT_EQ(count(FrameCut::kNone) + count(FrameCut::kPredictionOnly), 0);
  EXPECT_GE(reports_.back().inliers, Vehicle::Parameters{}.monitor.min_inliers);
  EXPECT_LT(reports_.back().inliers, usual);
  EXPECT_EQ(reports_.back().state, TrackingState::kTracking);

  drive(6, 700);
  EXPECT_LE(most_work(), 700);
  EXPECT_EQ(count(FrameCut::kPredictionOnly), 6);
  EXPECT_EQ(reports_.back().inliers, 0);
  EXPECT_EQ(reports_.back().state, TrackingState::kUncertain);
  EXPECT_LT(position_error(), 0.05);
  EXPECT_GE(tracker_->health().budget_exceeded, 12U);
}

/// A second without any work but prediction: no landmark is removed, and tracking is not lost.
TEST_F(VehicleWithAWorkLimit, TracksAgainWithinFiveFrames) {
  drive(kWarm, kOwnLimit);
  const int landmarks = reports_.back().landmarks;
  drive(30, 0);
  EXPECT_EQ(count(FrameCut::kPredictionOnly), 30);
  EXPECT_EQ(tracker_->health().losses, 0U);
  EXPECT_GE(reports_.back().landmarks, landmarks - 8);  // remembered positions may end
  drive(5, kOwnLimit);
  EXPECT_EQ(reports_.back().state, TrackingState::kTracking);
  EXPECT_GE(reports_.back().inliers, Vehicle::Parameters{}.monitor.min_inliers);
  EXPECT_LT(position_error(), 0.05);
}

/// Matching alone would take all of a tight limit for ever, and the vehicle would drive out of its
/// map.
TEST_F(VehicleWithAWorkLimit, GoesOnMappingUnderATightLimit) {
  drive(kWarm, kOwnLimit);
  drive(90, 4000);
  EXPECT_LE(most_work(), 4000);
  int added = 0;
  for (const FrameReport& report : reports_) added += report.added;
  EXPECT_GT(added, 10);
  EXPECT_EQ(reports_.back().state, TrackingState::kTracking);
  EXPECT_LT(position_error(), 0.1);
}

TEST(WorkLimit, FollowsFromTicksLeft) {
  static_assert(work_limit_for(24000000, 1500) == 16000, "ticks / ticks per unit");
  EXPECT_EQ(work_limit_for(1499, 1500), 0);
  EXPECT_EQ(work_limit_for(0xFFFFFFFFU, 1), 1000000);
  EXPECT_EQ(work_limit_for(24000000, 0), 0);
}

TEST_F(VehicleWithAWorkLimit, RefusesANegativeLimit) {
  EXPECT_EQ(tracker_->set_work_limit(-1), Status::kInvalidArgument);
  drive(1, kOwnLimit);
  EXPECT_EQ(count(FrameCut::kNone), 1);
}

}  // namespace
}  // namespace cairn
