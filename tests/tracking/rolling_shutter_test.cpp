#include "cairn/tracking/rolling_shutter.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr float kRowTime_s = 50e-6F;

const Vector3<float> kTurn(0.4F, -0.9F, 0.2F);
const Vector3<float> kVelocity(0.3F, -0.1F, 0.2F);

/// Where a camera that moves sees a point, `dt_s` after the frame's time.
Vector2<float> seen_at(const Vector3<float>& p, float dt_s) {
  const Vector3<float> q =
      rotation_exp(Vector3<float>(kTurn * dt_s)) * p + Vector3<float>(kVelocity * dt_s);
  return Vector2<float>(q.x() / q.z(), q.y() / q.z());
}

RollingShutter shutter(float row_time_s, float column_time_s) {
  RollingShutter result;
  result.reset(ReadoutTimes{row_time_s, column_time_s}, kWidth, kHeight);
  result.set_motion(kTurn, kVelocity);
  return result;
}

void expect_near(const Vector2<float>& a, const Vector2<float>& b, float tolerance) {
  EXPECT_LT((a - b).norm(), tolerance);
}

TEST(RollingShutter, GivesWhatIsSeenAtTheFrameTimeAndBack) {
  const Vector3<float> p(-0.5F, 0.6F, 2.0F);
  const Vector2<float> pixel(100.0F, 460.0F);
  const float row_s = kRowTime_s * (pixel.y() - 239.5F);
  const Vector2<float> at_frame(p.x() / p.z(), p.y() / p.z());
  const RollingShutter rows = shutter(kRowTime_s, 0.0F);
  ASSERT_GT((seen_at(p, row_s) - at_frame).norm(), 0.008F);  // 4 px
  expect_near(rows.at_frame_time(seen_at(p, row_s), pixel, 1.0F / p.z()), at_frame, 1e-4F);
  expect_near(rows.at_pixel_time(at_frame, pixel, 1.0F / p.z()), seen_at(p, row_s), 1e-6F);

  const float column_s = -kRowTime_s * (pixel.x() - 319.5F);
  const RollingShutter columns = shutter(0.0F, -kRowTime_s);
  expect_near(columns.at_pixel_time(at_frame, pixel, 1.0F / p.z()), seen_at(p, column_s), 1e-6F);
}

TEST(RollingShutter, ChangesNothingWithoutTimesOrMovement) {
  const Vector2<float> seen(0.3F, -0.2F);
  const Vector2<float> pixel(500.0F, 20.0F);
  EXPECT_FALSE(shutter(0.0F, 0.0F).used());
  EXPECT_EQ(shutter(0.0F, 0.0F).at_frame_time(seen, pixel, 0.5F), seen);
  RollingShutter forgotten = shutter(kRowTime_s, 0.0F);
  forgotten.forget_motion();
  EXPECT_TRUE(forgotten.used());
  EXPECT_EQ(forgotten.at_frame_time(seen, pixel, 0.5F), seen);
}

TEST(RollingShutter, ThePictureBetweenTwoMovementsHasTheirMean) {
  const Vector2<float> seen(0.3F, -0.2F);
  const Vector2<float> pixel(320.0F, 479.0F);
  const RollingShutter moving = shutter(kRowTime_s, 0.0F);
  RollingShutter faster = moving;
  faster.set_motion(3.0F * kTurn, 3.0F * kVelocity);
  RollingShutter mean = moving;
  mean.set_motion(2.0F * kTurn, 2.0F * kVelocity);
  expect_near(moving.with_next(faster).at_frame_time(seen, pixel, 0.5F),
              mean.at_frame_time(seen, pixel, 0.5F), 1e-6F);
  RollingShutter first = moving;
  first.forget_motion();
  EXPECT_EQ(first.with_next(faster).at_frame_time(seen, pixel, 0.5F),
            faster.at_frame_time(seen, pixel, 0.5F));
}

TEST(RollingShutter, RefusesTimesThatNoCameraHas) {
  const auto valid = [](float row, float column) {
    return ok(ReadoutTimes{row, column}.validate(kWidth, kHeight));
  };
  EXPECT_TRUE(valid(0.0F, 0.0F));
  EXPECT_TRUE(valid(-kRowTime_s, 0.0F));
  EXPECT_TRUE(valid(400e-6F, 0.0F));
  EXPECT_FALSE(valid(430e-6F, 0.0F));
  EXPECT_FALSE(valid(300e-6F, -300e-6F));
  EXPECT_FALSE(valid(std::numeric_limits<float>::quiet_NaN(), 0.0F));
  EXPECT_FALSE(valid(0.0F, std::numeric_limits<float>::infinity()));
}

}  // namespace
}  // namespace cairn
