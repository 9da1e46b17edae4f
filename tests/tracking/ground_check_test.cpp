#include "cairn/tracking/ground_check.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr float kHeight_m = 1.6F;

/// GIVEN a camera said to be 1.6 m above the ground.
class GroundBelowACamera : public ::testing::Test {
 protected:
  GroundBelowACamera() { check_.reset(kHeight_m); }
  /// Landmarks on a ground `ratio` camera heights below, 5 % uneven, and as many on what stands on
  /// it.
  void see_street(float ratio, int landmarks) {
    for (int i = 0; i < landmarks; ++i) {
      const float uneven = 0.05F * static_cast<float>(i % 3 - 1);
      check_.note_landmark(kHeight_m * ratio * (1.0F + uneven));
      check_.note_landmark(kHeight_m * ratio * (0.3F + 0.5F * static_cast<float>(i % 7) / 7.0F));
    }
  }
  void drive(float correction_share, float distance_m) {
    for (float d = 0.0F; d < distance_m; d += 0.1F) {
      check_.note_step(0.1F, 0.1F * correction_share);
    }
  }

  GroundCheck check_;
};

TEST_F(GroundBelowACamera, IsWhereTheHeightSays) {
  see_street(1.0F, 30);
  EXPECT_NEAR(check_.ratio(), 1.0F, 0.05F);
  EXPECT_FALSE(check_.suspect());
}

/// km/h for m/s, and a camera that is higher than was told.
TEST_F(GroundBelowACamera, IsLowerWhereSpeedIsTooLargeOrHeightTooSmall) {
  for (const float ratio : {3.6F, 1.25F}) {
    check_.reset(kHeight_m);
    see_street(ratio, 30);
    EXPECT_NEAR(check_.ratio() / ratio, 1.0F, 0.06F);
    EXPECT_TRUE(check_.suspect()) << ratio;
  }
}

/// A camera that faces a wall sees nothing lower than the picture's last row.
TEST_F(GroundBelowACamera, IsNotDoubtedForWhatLiesHigher) {
  for (const float ratio : {0.8F, 0.5F}) {
    check_.reset(kHeight_m);
    see_street(ratio, 30);
    EXPECT_NEAR(check_.ratio() / ratio, 1.0F, 0.06F);
    EXPECT_FALSE(check_.suspect()) << ratio;
  }
}

TEST_F(GroundBelowACamera, IsNotKnownByAFewLandmarks) {
  see_street(3.6F, 11);
  EXPECT_EQ(check_.ratio(), 0.0F);
  EXPECT_FALSE(check_.suspect());
  see_street(3.6F, 1);
  EXPECT_TRUE(check_.suspect());
}

/// Heights that nothing shares, and a shelf with much below it, are no ground.
TEST_F(GroundBelowACamera, IsNotKnownWhereNothingLooksLikeIt) {
  for (int i = 0; i < 60; ++i) {
    check_.note_landmark(kHeight_m * (0.25F + 4.0F * static_cast<float>(i) / 60.0F));
  }
  EXPECT_EQ(check_.ratio(), 0.0F);
  check_.reset(kHeight_m);
  for (int i = 0; i < 30; ++i) check_.note_landmark(0.5F * kHeight_m);
  for (int i = 0; i < 10; ++i) check_.note_landmark(1.0F * kHeight_m);
  EXPECT_EQ(check_.ratio(), 0.0F);
  EXPECT_FALSE(check_.suspect());
}

/// The unit was corrected on the way: old counts fade.
TEST_F(GroundBelowACamera, IsFoundAgainAfterAChange) {
  see_street(3.6F, 60);
  ASSERT_TRUE(check_.suspect());
  see_street(1.0F, 250);
  EXPECT_FALSE(check_.suspect());
}

/// Where the floor gives the map its scale the ground is at its height whatever odometry says.
TEST_F(GroundBelowACamera, ShowsInDistancesWhereTheFloorGivesTheScale) {
  see_street(1.0F, 30);
  drive(-0.2F, 5.0F);
  EXPECT_FALSE(check_.suspect()) << "3 heights of the camera tell nothing";
  drive(-0.2F, 20.0F);
  EXPECT_NEAR(check_.ratio(), 1.25F, 0.01F);
  EXPECT_TRUE(check_.suspect());
  drive(0.0F, 80.0F);
  EXPECT_FALSE(check_.suspect());
}

TEST_F(GroundBelowACamera, IsNotDoubtedForNoiseOfTheOdometry) {
  for (int i = 0; i < 400; ++i) check_.note_step(0.1F, i % 2 == 0 ? 0.08F : -0.08F);
  EXPECT_FALSE(check_.suspect());
  EXPECT_NEAR(check_.ratio(), 1.0F, 0.02F);
}

TEST_F(GroundBelowACamera, SaysNothingOfACameraOnTheGround) {
  for (const float height : {0.0F, -0.3F}) {
    check_.reset(height);
    see_street(3.6F, 30);
    drive(-0.2F, 50.0F);
    EXPECT_EQ(check_.ratio(), 0.0F);
    EXPECT_FALSE(check_.suspect());
  }
}

/// A vehicle whose camera is told to be 1 m high drives over landmarks, one every `apart_m`.
GroundCheck drive_over(const std::vector<float>& below_m, float apart_m) {
  GroundCheck check;
  check.reset(1.0F);
  for (const float below : below_m) {
    for (int k = 0; k < 10; ++k) check.note_way(0.1F * apart_m);
    check.note_on_way(below);
  }
  return check;
}

TEST(GroundOnTheWay, TellsSpeedsThatAreTooSmallOrAHeightThatIsTooLarge) {
  const std::vector<float> seen = {0.8F, 0.84F, 0.78F, 0.81F, 0.79F};
  const GroundCheck check = drive_over(seen, 1.01F);
  EXPECT_TRUE(check.suspect());
  EXPECT_NEAR(check.ratio(), 0.8F, 0.02F);
  EXPECT_FALSE(drive_over({seen.begin(), seen.end() - 1}, 1.01F).suspect()) << "too few";
}

TEST(GroundOnTheWay, SaysNothingOfTheGroundWhereItWasTold) {
  EXPECT_FALSE(drive_over({1.0F, 0.95F, 1.05F, 0.9F, 1.1F, 0.97F, 1.0F, 0.92F}, 1.01F).suspect());
}

/// It comes up to a box before which it stops, again and again.
TEST(GroundOnTheWay, SaysNothingOfWhatIsNotDrivenOver) {
  EXPECT_FALSE(drive_over(std::vector<float>(30, 0.8F), 0.1F).suspect());
}

/// The wall behind a curve fills the picture from the ground to the camera's height.
TEST(GroundOnTheWay, SaysNothingOfAWall) {
  std::vector<float> wall;
  for (int i = 0; i < 40; ++i)
    wall.push_back(0.35F + 0.65F * static_cast<float>(i * 7 % 40) / 40.0F);
  EXPECT_FALSE(drive_over(wall, 1.01F).suspect());
}

TEST(GroundOnTheWay, BearsPlacesThatAreNone) {
  EXPECT_FALSE(drive_over({-1.0F, 0.0F, 1e-30F, 1e30F, 1e-30F, 1e30F, 1e-30F}, 1e6F).suspect());
}

}  // namespace
}  // namespace cairn
