#include "cairn/tracking/reentry_rule.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(ReentryRule, AllowsLandmarksFromBeforeTheLastSixteenMetres) {
  ReentryRule rule;
  LandmarkId next = 10;
  for (int step = 0; step < 7; ++step) rule.move_on(2.0F, next++);
  EXPECT_FALSE(rule.allows(1));
  rule.move_on(2.0F, next++);
  EXPECT_TRUE(rule.allows(9));
  EXPECT_FALSE(rule.allows(10));
  rule.move_on(1.5F, next);
  EXPECT_FALSE(rule.allows(10));
  rule.move_on(0.5F, next);
  EXPECT_TRUE(rule.allows(10));
  EXPECT_FALSE(rule.allows(11));
}

TEST(ReentryRule, TakesALibraryFromElsewhereForOld) {
  ReentryRule rule;
  rule.take_for_old(100);
  EXPECT_TRUE(rule.allows(99));
  EXPECT_FALSE(rule.allows(100));
  rule.reset();
  EXPECT_FALSE(rule.allows(99));
}

TEST(ReentryRule, ForgetsARefusalAfterThirtyTwoOthers) {
  ReentryRule rule;
  rule.take_for_old(1000);
  rule.refuse(7);
  EXPECT_FALSE(rule.allows(7));
  EXPECT_TRUE(rule.allows(8));
  for (LandmarkId other = 100; other < 131; ++other) rule.refuse(other);
  EXPECT_FALSE(rule.allows(7));
  rule.refuse(131);
  EXPECT_TRUE(rule.allows(7));
}

}  // namespace
}  // namespace cairn
