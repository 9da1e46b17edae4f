#include "cairn/tracking/vehicle_doubt.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

/// Takes what odometry moves.
struct AnyFilter {
  Status predict(const PlanarIncrement<float>&) { return Status::kOk; }
  Status widen_pose(float, float) { return Status::kOk; }
  Status slip_laterally(float) { return Status::kOk; }
};

/// GIVEN a vehicle whose camera looks ahead over grey columns, at 30 frames a second.
class DoubtOfAVehicle : public ::testing::Test {
 protected:
  static constexpr int kWidth = 320;
  static constexpr int kHeight = 240;
  static constexpr std::int64_t kFrameUs = 33333;
  static constexpr float kFrameS = 0.033333F;
  static constexpr float kFocal = 250.0F;

  DoubtOfAVehicle() : pixels_(kWidth * kHeight) {
    camera_.fx = camera_.fy = kFocal;
    camera_.cx = 159.5F;
    camera_.cy = 119.5F;
    camera_.width = kWidth;
    camera_.height = kHeight;
    Random random(3);
    float grey = 120.0F;
    for (float& column : columns_) {
      grey = clamp(grey + 3.0F * static_cast<float>(random.below(9) - 4), 20.0F, 230.0F);
      column = grey;
    }
    doubt_.reset(camera_, {{0.5F, -0.5F, 0.5F, -0.5F}, {0.0F, 0.0F, 1.0F}}, 0.5F);
    odometry_.reset(OdometryNoise{}, 1000000, 0);
    work_.reset(1000, 0);
  }

  /// Frames of a turn by `true_radps`, of which odometry says `told_radps`.
  void turn(int frames, float true_radps, float told_radps) {
    for (int k = 0; k < frames; ++k) {
      OdometrySample sample;
      sample.t_us = t_us_ += kFrameUs;
      sample.speed_mps = 0.6F;
      sample.turn = told_radps;
      ASSERT_TRUE(ok(odometry_.add(sample, filter_, health_)));
      heading_ += true_radps * kFrameS;
      compare();
      odometry_.forget_yaw();
    }
  }

  void compare() {
    for (int u = 0; u < kWidth; ++u) {
      const float angle = heading_ - (static_cast<float>(u) - camera_.cx) / kFocal;
      const int column = round_to_int(400.0F * (10.0F + angle));
      for (int v = 0; v < kHeight; ++v) {
        pixels_[v * kWidth + u] = static_cast<std::uint8_t>(columns_[column % kColumns]);
      }
    }
    const ImageView image{pixels_.data(), kWidth, kHeight, kWidth};
    work_.begin(0);
    FrameContext frame{image, camera_, work_, random_, report_, health_};
    doubt_.compare(frame, odometry_, Vector2<float>::Zero(), kFrameS, nullptr, 0);
    work_.end(0, report_, health_);
  }

  static constexpr int kColumns = 4096;
  float columns_[kColumns];
  PinholeCamera<float> camera_;
  std::vector<std::uint8_t> pixels_;
  VehicleDoubt doubt_;
  OdometryIntegrator odometry_;
  AnyFilter filter_;
  FrameWork work_;
  Random random_{1};
  FrameReport report_;
  Health health_;
  std::int64_t t_us_ = 0;
  float heading_ = 0.0F;
};

TEST_F(DoubtOfAVehicle, IsOfAnOdometryThatIsSilent) {
  EXPECT_TRUE(doubt_.contradicts(odometry_));
  compare();
  EXPECT_EQ(report_.work, 0) << "there is nothing to compare matches with";
  turn(1, 0.0F, 0.0F);
  EXPECT_FALSE(doubt_.contradicts(odometry_));
  EXPECT_EQ(report_.work, work::kMountCheck);
}

TEST_F(DoubtOfAVehicle, IsOfTurnsThatThePicturesDoNotShow) {
  turn(90, 0.4F, 0.4F);
  EXPECT_FALSE(doubt_.contradicts(odometry_));
  EXPECT_EQ(health_.yaw_suspicions, 0U);
  turn(90, 0.4F, -0.4F);
  EXPECT_TRUE(doubt_.yaw().suspect());
  EXPECT_TRUE(doubt_.contradicts(odometry_));
  EXPECT_GT(health_.yaw_suspicions, 0U);
}

TEST_F(DoubtOfAVehicle, IsOfAHeadingThatWasNotSeenForLong) {
  const float of_a_frame = square(0.05F);
  EXPECT_FALSE(doubt_.heading_unsure(of_a_frame));
  for (int k = 0; k < 5; ++k) doubt_.note_pose(false, of_a_frame);
  EXPECT_FALSE(doubt_.heading_unsure(0.0F));
  EXPECT_TRUE(doubt_.heading_unsure(of_a_frame));
  doubt_.note_pose(true, of_a_frame);
  EXPECT_FALSE(doubt_.heading_unsure(of_a_frame));
  for (int k = 0; k < 6; ++k) doubt_.note_pose(false, of_a_frame);
  ASSERT_TRUE(doubt_.heading_unsure(0.0F));
  doubt_.trust_pose();
  EXPECT_FALSE(doubt_.heading_unsure(0.0F));
}

}  // namespace
}  // namespace cairn
