#include "cairn/base/time.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();

TEST(DifferenceUs, IsClampedWhereItDoesNotFit) {
  EXPECT_EQ(difference_us(7, 3), 4);
  EXPECT_EQ(difference_us(-7, 3), -10);
  EXPECT_EQ(difference_us(kMax, 0), kMax);
  EXPECT_EQ(difference_us(kMax, -1), kMax);
  EXPECT_EQ(difference_us(kMin, 1), kMin);
  EXPECT_EQ(difference_us(0, kMin), kMax);
  EXPECT_EQ(difference_us(kMin, kMax), kMin);
  EXPECT_EQ(difference_us(-1, kMin), kMax);
}

TEST(WrappingClock, GoesOnWhereTheCounterWraps) {
  WrappingClock clock;
  EXPECT_EQ(clock.extend(0xFFFFFF00U), 0xFFFFFF00LL);
  EXPECT_EQ(clock.extend(0x00000100U), 0x100000100LL);
  EXPECT_EQ(clock.extend(0x80000000U), 0x180000000LL);
  EXPECT_EQ(clock.extend(0xFFFFFFFFU), 0x1FFFFFFFFLL);
  EXPECT_EQ(clock.extend(0U), 0x200000000LL);
}

TEST(WrappingClock, TakesAnOlderStampAsOlder) {
  WrappingClock clock;
  static_cast<void>(clock.extend(0xFFFFFF00U));
  static_cast<void>(clock.extend(0x00000100U));
  EXPECT_EQ(clock.extend(0xFFFFFFF0U), 0xFFFFFFF0LL);
  EXPECT_EQ(clock.extend(0x00000200U), 0x100000200LL);
}

TEST(WrappingClock, CountsTheFirstStampFromZero) {
  WrappingClock clock;
  EXPECT_EQ(clock.extend(0U), 0);
  EXPECT_EQ(clock.extend(5U), 5);
}

}  // namespace
}  // namespace cairn
