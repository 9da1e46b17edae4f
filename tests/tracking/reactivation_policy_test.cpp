#include "cairn/tracking/reactivation_policy.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(ReactivationPolicy, AllowsLandmarksFromBeforeTheLastSixteenMetres) {
  ReactivationPolicy policy;
  LandmarkId next = 10;
  for (int step = 0; step < 7; ++step) policy.travel(2.0F, next++);
  EXPECT_FALSE(policy.allows(1));
  policy.travel(2.0F, next++);
  EXPECT_TRUE(policy.allows(9));
  EXPECT_FALSE(policy.allows(10));
  policy.travel(1.5F, next);
  EXPECT_FALSE(policy.allows(10));
  policy.travel(0.5F, next);
  EXPECT_TRUE(policy.allows(10));
  EXPECT_FALSE(policy.allows(11));
}

TEST(ReactivationPolicy, AllowsAllOfASavedLibrary) {
  ReactivationPolicy policy;
  policy.allow_below(100);
  EXPECT_TRUE(policy.allows(99));
  EXPECT_FALSE(policy.allows(100));
  policy.reset();
  EXPECT_FALSE(policy.allows(99));
}

TEST(ReactivationPolicy, ForgetsARefusalAfterThirtyTwoOthers) {
  ReactivationPolicy policy;
  policy.allow_below(1000);
  policy.refuse(7);
  EXPECT_FALSE(policy.allows(7));
  EXPECT_TRUE(policy.allows(8));
  for (LandmarkId other = 100; other < 131; ++other) policy.refuse(other);
  EXPECT_FALSE(policy.allows(7));
  policy.refuse(131);
  EXPECT_TRUE(policy.allows(7));
}

}  // namespace
}  // namespace cairn
