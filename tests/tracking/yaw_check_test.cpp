#include "cairn/tracking/yaw_check.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

constexpr float kStep_s = 1.0F / 30.0F;

float uniform(Random& random) {
  return static_cast<float>(random.below(1 << 16)) / 65536.0F;
}

/// GIVEN a camera that looks along the way of a vehicle with 0.6 m/s, which turns by 0.4 rad/s
/// every other two seconds, before a panorama of grey columns that looms as what is 4 m ahead does.
class TurningVehicle : public ::testing::Test {
 protected:
  static constexpr int kColumns = 4096;

  TurningVehicle() : panorama_(kColumns), pixels_(320 * 240) {
    camera_.fx = camera_.fy = 250.0F;
    camera_.cx = 159.5F;
    camera_.cy = 119.5F;
    camera_.width = 320;
    camera_.height = 240;
    Random random(3);
    float grey = 120.0F;
    for (float& column : panorama_) {
      grey = clamp(grey + 24.0F * (uniform(random) - 0.5F), 20.0F, 230.0F);
      column = grey;
    }
  }
  static Rigid<float> looking(const Vector3<float>& along) {
    Matrix3<float> R;
    R.col(2) = along;
    R.col(1) = Vector3<float>(0.0F, 0.0F, -1.0F);
    R.col(0) = Vector3<float>(R.col(1)).cross(along);
    return {Quaternion<float>(R), Vector3<float>(0.0F, 0.0F, 1.0F)};
  }

  /// What odometry says: `told` times the yaw rate, with noise.
  void drive(float seconds, float told, float sigma_radps = 0.05F) {
    for (const float end = t_s_ + seconds; t_s_ < end; t_s_ += kStep_s) {
      const bool turning = static_cast<int>(t_s_ / 2.0F) % 2 == 1;
      const float rate = turning ? 0.4F : 0.0F;
      heading_ += kStep_s * rate;
      ToldYaw way;
      told_ += kStep_s * (told * rate + sigma_radps * 3.46F * (uniform(random_) - 0.5F));
      way.heading = wrap_angle(told_);
      way.variance = square(kStep_s * sigma_radps);
      way.speed_mps = 0.6F;
      way.step_s = kStep_s;
      draw();
      check_.add({pixels_.data(), 320, 240, 320}, way);
      if (check_.suspect() && first_s_ < 0.0F) first_s_ = t_s_;
    }
  }

  void draw() {
    const float looming = 1.0F - 0.15F * (t_s_ / 2.0F - static_cast<float>(int(t_s_ / 2.0F)));
    for (int u = 0; u < 320; ++u) {
      const float angle = looming * (static_cast<float>(u) - 159.5F) / 250.0F - heading_ + 40.0F;
      const float at = 400.0F * angle;
      const int column = static_cast<int>(at);
      const float share = at - static_cast<float>(column);
      const float grey = (1.0F - share) * panorama_[static_cast<std::size_t>(column % kColumns)] +
                         share * panorama_[static_cast<std::size_t>((column + 1) % kColumns)];
      for (int v = 0; v < 240; ++v) {
        pixels_[static_cast<std::size_t>(320 * v + u)] = static_cast<std::uint8_t>(grey);
      }
    }
  }

  PinholeCamera<float> camera_;
  std::vector<float> panorama_;
  std::vector<std::uint8_t> pixels_;
  Random random_{1};
  float t_s_ = 0.0F;
  float heading_ = 0.0F;
  float told_ = 0.0F;
  float first_s_ = -1.0F;
  YawCheck check_;
};

TEST_F(TurningVehicle, IsNeverSuspectedOfATurnThatThePicturesShow) {
  for (const float along : {1.0F, -1.0F}) {
    check_.reset(camera_, looking(Vector3<float>(along, 0.0F, 0.0F)));
    drive(60.0F, 1.0F, 0.15F);
    EXPECT_LT(first_s_, 0.0F) << along;
    EXPECT_NEAR(check_.ratio(), 1.0F, 0.2F);
  }
}

TEST_F(TurningVehicle, IsSuspectedOfTheOtherSign) {
  check_.reset(camera_, looking(Vector3<float>(1.0F, 0.0F, 0.0F)));
  drive(8.0F, -1.0F);
  EXPECT_TRUE(check_.suspect());
  EXPECT_GT(first_s_, 3.0F);
  EXPECT_LT(first_s_, 4.0F) << "a second after it began to turn";
  EXPECT_NEAR(check_.ratio(), -1.0F, 0.2F);
}

TEST_F(TurningVehicle, IsSuspectedOfDegreesForRadians) {
  check_.reset(camera_, looking(Vector3<float>(1.0F, 0.0F, 0.0F)));
  drive(8.0F, 57.3F);
  EXPECT_TRUE(check_.suspect());
  EXPECT_GT(check_.ratio(), 30.0F);
}

TEST_F(TurningVehicle, IsBelievedAgainAfterASecondOfATurnThatFits) {
  check_.reset(camera_, looking(Vector3<float>(1.0F, 0.0F, 0.0F)));
  drive(8.0F, -1.0F);
  ASSERT_TRUE(check_.suspect());
  drive(12.0F, 1.0F);
  EXPECT_FALSE(check_.suspect());
}

/// What passes a camera that looks to the side moves like a turn.
TEST_F(TurningVehicle, SaysNothingOfACameraThatLooksToTheSide) {
  check_.reset(camera_, looking(Vector3<float>(0.0F, 1.0F, 0.0F)));
  drive(8.0F, -1.0F);
  EXPECT_FALSE(check_.suspect());
  EXPECT_EQ(check_.ratio(), 0.0F);
}

TEST_F(TurningVehicle, SaysNothingOfAPictureWithoutTexture) {
  check_.reset(camera_, looking(Vector3<float>(1.0F, 0.0F, 0.0F)));
  for (float& column : panorama_) column = 120.0F;
  drive(8.0F, -1.0F);
  EXPECT_FALSE(check_.suspect());
}

/// A turn by a whole period looks like none.
TEST_F(TurningVehicle, SaysNothingOfAPatternThatRepeats) {
  check_.reset(camera_, looking(Vector3<float>(1.0F, 0.0F, 0.0F)));
  for (int i = 0; i < kColumns; ++i) {
    panorama_[static_cast<std::size_t>(i)] = i / 32 % 2 == 0 ? 60.0F : 180.0F;
  }
  drive(8.0F, 1.0F);
  EXPECT_FALSE(check_.suspect());
  EXPECT_EQ(check_.ratio(), 0.0F);
}

TEST_F(TurningVehicle, IsNotSuspectedOfWhatTheNoiseOfItsOdometryDoes) {
  check_.reset(camera_, looking(Vector3<float>(1.0F, 0.0F, 0.0F)));
  drive(60.0F, 1.0F, 4.0F);
  EXPECT_LT(first_s_, 0.0F);
}

}  // namespace
}  // namespace cairn
