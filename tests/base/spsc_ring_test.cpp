#include "cairn/base/spsc_ring.hpp"

#include <thread>

#include <gtest/gtest.h>

namespace cairn {
namespace {

TEST(SpscRing, KeepsTheOrderAndRefusesWhatDoesNotFit) {
  SpscRing<int, 4> ring;
  EXPECT_EQ(ring.front(), nullptr);
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 4; ++i) EXPECT_TRUE(ring.push(10 * round + i));
    EXPECT_FALSE(ring.push(99));
    for (int i = 0; i < 4; ++i) {
      ASSERT_NE(ring.front(), nullptr);
      EXPECT_EQ(*ring.front(), 10 * round + i);
      ring.pop();
    }
    EXPECT_EQ(ring.front(), nullptr);
  }
}

TEST(SpscRing, CopiesWhatIsWaiting) {
  SpscRing<int, 4> ring;
  ASSERT_TRUE(ring.push(1));
  ASSERT_TRUE(ring.push(2));
  ring.pop();
  const SpscRing<int, 4> copy = ring;
  ASSERT_NE(copy.front(), nullptr);
  EXPECT_EQ(*copy.front(), 2);
}

TEST(SpscRing, TwoThreadsLoseNothing) {
  constexpr int kCount = 200000;
  SpscRing<int, 8> ring;
  std::thread writer([&ring] {
    for (int i = 0; i < kCount;) i += ring.push(i) ? 1 : 0;
  });
  int expected = 0;
  int wrong = 0;
  while (expected < kCount) {
    const int* value = ring.front();
    if (value == nullptr) continue;
    wrong += *value == expected ? 0 : 1;
    ++expected;
    ring.pop();
  }
  writer.join();
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace cairn
