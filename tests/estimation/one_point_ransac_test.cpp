#include "cairn/estimation/one_point_ransac.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "cairn/estimation/candidates_first.hpp"

namespace cairn {
namespace {

TEST(CandidatesFirst, MoveInliersToTheFrontInTheirOrder) {
  int items[] = {10, 11, 12, 13, 14};
  const bool flags[] = {false, true, false, true, true};
  ASSERT_EQ(detail::flagged_first(items, flags, 5), 3);
  EXPECT_EQ(items[0], 11);
  EXPECT_EQ(items[1], 13);
  EXPECT_EQ(items[2], 14);
}

TEST(CandidatesFirst, AskEachItemOnceAndMoveTheBadToTheEnd) {
  int items[] = {1, 2, 3, 4, 6};
  int asked = 0;
  const auto odd = [&](int item) {
    ++asked;
    return item % 2 == 1;
  };
  ASSERT_EQ(detail::good_first(items, 5, odd), 2);
  EXPECT_EQ(asked, 5);
  EXPECT_EQ(items[0] + items[1], 4);
  EXPECT_EQ(items[2] + items[3] + items[4], 12);
}

TEST(HypothesesNeeded, FollowsTheFormulaAndItsLimits) {
  for (const float share : {0.2F, 0.5F, 0.75F, 0.9F, 0.99F}) {
    const int want = static_cast<int>(std::ceil(std::log(0.01) / std::log(1.0 - share)));
    EXPECT_NEAR(hypotheses_needed(0.99F, share, 1000), want,
                share == 0.99F || share == 0.9F ? 1 : 0);
  }
  EXPECT_EQ(hypotheses_needed(0.99F, 1.0F, 16), 1);
  EXPECT_EQ(hypotheses_needed(0.99F, 0.0F, 16), 16);
  EXPECT_EQ(hypotheses_needed(0.99F, 0.05F, 16), 16);
}

/// Candidates 0..good-1 agree with one another, every other one with itself alone.
struct Clustered {
  int count;
  int good;
  int calls = 0;

  int operator()(int candidate, bool* inliers) {
    ++calls;
    int inlier_count = 0;
    for (int i = 0; i < count; ++i) {
      inliers[i] = candidate < good ? i < good : i == candidate;
      inlier_count += inliers[i] ? 1 : 0;
    }
    return inlier_count;
  }
};

TEST(OnePointRansac, LoopShortensOnceAGoodHypothesisIsFound) {
  Random random(3);
  Clustered all_good{20, 20};
  const auto result = one_point_ransac<32>(20, {}, random, all_good);
  EXPECT_EQ(all_good.calls, 1);
  EXPECT_TRUE(result.consensus);
  EXPECT_EQ(result.inlier_count, 20);
}

TEST(OnePointRansac, FindsTheClusterAmongHalfOutliersInEverySeed) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    Clustered half{24, 12};
    const auto result = one_point_ransac<24>(24, {}, random, half);
    EXPECT_TRUE(result.consensus) << seed;
    EXPECT_LE(half.calls, 16);
    for (int i = 0; i < 24; ++i) EXPECT_EQ(result.inliers[i], i < 12);
  }
}

TEST(OnePointRansac, CandidatesAreDrawnOnceEach) {
  Random random(9);
  bool seen[16] = {};
  auto lonely = [&](int candidate, bool* inliers) {
    EXPECT_FALSE(seen[candidate]);
    seen[candidate] = true;
    inliers[candidate] = true;
    return 1;
  };
  const auto result = one_point_ransac<16>(16, {}, random, lonely);
  EXPECT_EQ(result.hypotheses, 16);
  EXPECT_FALSE(result.consensus);
}

TEST(ThreePointRansac, DrawsDifferentCandidatesAndKeepsTheBest) {
  Random random(3);
  OnePointRansacResult<16> best;
  best.inlier_count = 4;
  int calls = 0;
  auto evaluate = [&](const int* candidates, bool* inliers) {
    ++calls;
    EXPECT_NE(candidates[0], candidates[1]);
    EXPECT_NE(candidates[0], candidates[2]);
    EXPECT_NE(candidates[1], candidates[2]);
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(candidates[k], 0);
      EXPECT_LT(candidates[k], 12);
      inliers[candidates[k]] = true;
    }
    return calls == 5 ? 6 : 3;
  };
  three_point_ransac<16>(12, {}, 10, random, evaluate, best);
  EXPECT_EQ(best.triples, calls);
  EXPECT_EQ(calls, 10);
  EXPECT_EQ(best.inlier_count, 6);
  EXPECT_TRUE(best.consensus);

  OnePointRansacResult<16> two;
  three_point_ransac<16>(2, {}, 10, random, evaluate, two);
  EXPECT_EQ(two.triples, 0);
  auto all = [](const int*, bool*) { return 12; };
  OnePointRansacResult<16> sure;
  three_point_ransac<16>(12, {}, 10, random, all, sure);
  EXPECT_EQ(sure.triples, 1);
}

TEST(OnePointRansac, FewInliersAreNoConsensus) {
  Random random(1);
  Clustered four{4, 4};
  EXPECT_FALSE(one_point_ransac<8>(4, {}, random, four).consensus);
  Clustered fifth{30, 6};
  EXPECT_FALSE(one_point_ransac<32>(30, {}, random, fifth).consensus);
  Clustered none{0, 0};
  EXPECT_FALSE(one_point_ransac<8>(0, {}, random, none).consensus);
  EXPECT_EQ(none.calls, 0);
}

}  // namespace
}  // namespace cairn
