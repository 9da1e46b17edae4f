#include "cairn/tracking/input_clock.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr std::int64_t kSecond = 1000000;
constexpr std::int64_t kHour = 3600 * kSecond;
constexpr std::int64_t kStep = 33333;

/// GIVEN a tracker that has had frames and odometry for a second, both at 30 Hz.
class AClockOfTwoSources : public ::testing::Test {
 protected:
  AClockOfTwoSources() {
    clock_.reset(kSecond);
    for (int k = 0; k <= 30; ++k) {
      EXPECT_TRUE(ok(odometry(k * kStep)));
      EXPECT_TRUE(ok(frame(k * kStep)));
    }
  }
  Status odometry(std::int64_t t_us) { return clock_.take(InputClock::Source::kOdometry, t_us); }
  Status frame(std::int64_t t_us) { return clock_.take(InputClock::Source::kFrame, t_us); }

  static constexpr std::int64_t kNow = 31 * kStep;
  InputClock clock_;
};

TEST_F(AClockOfTwoSources, RefusesOneStampAheadAndBelievesTheNext) {
  EXPECT_EQ(odometry(kNow + kHour), Status::kTimeGap);
  EXPECT_EQ(frame(kNow), Status::kOk);
  EXPECT_FALSE(clock_.jumped());
  EXPECT_EQ(frame(kNow + kHour), Status::kTimeGap);
  EXPECT_EQ(odometry(kNow + kStep), Status::kOk);
  EXPECT_EQ(frame(kNow + kStep), Status::kOk);
}

TEST_F(AClockOfTwoSources, BelievesAGapThatBothSourcesShow) {
  EXPECT_EQ(odometry(5 * kSecond), Status::kTimeGap);
  EXPECT_EQ(frame(5 * kSecond), Status::kOk);
  EXPECT_TRUE(clock_.jumped());
  EXPECT_EQ(clock_.jump_us(), 5 * kSecond - 30 * kStep);
  EXPECT_EQ(odometry(5 * kSecond + kStep), Status::kOk);
  EXPECT_FALSE(clock_.jumped());
}

TEST_F(AClockOfTwoSources, BelievesAClockThatStartedAnew) {
  EXPECT_EQ(frame(-kHour), Status::kTimeBackwards);
  EXPECT_EQ(odometry(-kHour + kStep), Status::kOk);
  EXPECT_TRUE(clock_.jumped());
  EXPECT_LT(clock_.jump_us(), -kHour);
  EXPECT_EQ(frame(-kHour + kStep), Status::kOk);
}

TEST_F(AClockOfTwoSources, DoesNotFollowOneSourceOnAnotherClock) {
  for (int k = 1; k < 100; ++k) {
    for (int j = 0; j < 3; ++j) {
      EXPECT_EQ(odometry(kNow + kHour + k * kStep + j * 10000), Status::kTimeGap);
    }
    EXPECT_EQ(frame(kNow + k * kStep), Status::kOk);
  }
}

TEST_F(AClockOfTwoSources, BelievesAJumpOfOneSourceOnceTheOtherHasFallenSilent) {
  int refused = 0;
  while (!ok(frame(10 * kSecond + refused * kStep))) ++refused;
  EXPECT_EQ(refused, InputClock::kStubborn - 1);
  EXPECT_TRUE(clock_.jumped());
}

TEST_F(AClockOfTwoSources, RefusesJumpsThatDoNotAgree) {
  for (int k = 1; k < 40; ++k) {
    EXPECT_EQ(odometry(k * kHour), Status::kTimeGap);
    EXPECT_EQ(frame(k * kHour + kHour / 2), Status::kTimeGap);
  }
  EXPECT_EQ(frame(kNow), Status::kOk);
}

TEST(AClockOfOneSource, NeedsOneStampMoreForAJump) {
  InputClock clock;
  clock.reset(kSecond);
  EXPECT_EQ(clock.take(InputClock::Source::kFrame, -5 * kHour), Status::kOk);
  EXPECT_EQ(clock.take(InputClock::Source::kFrame, kHour), Status::kTimeGap);
  EXPECT_EQ(clock.take(InputClock::Source::kFrame, kHour + kStep), Status::kOk);
  EXPECT_TRUE(clock.jumped());
}

TEST(AClockOfOneSource, TakesAnyStampWithoutOverflow) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
  InputClock clock;
  clock.reset(kSecond);
  EXPECT_EQ(clock.take(InputClock::Source::kFrame, kMin), Status::kOk);
  EXPECT_EQ(clock.take(InputClock::Source::kFrame, kMax), Status::kTimeGap);
  EXPECT_EQ(clock.take(InputClock::Source::kFrame, kMax), Status::kOk);
  EXPECT_EQ(clock.jump_us(), kMax);
  EXPECT_EQ(clock.take(InputClock::Source::kFrame, kMin), Status::kTimeBackwards);
}

}  // namespace
}  // namespace cairn
