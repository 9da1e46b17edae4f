// The example that takes frames by DMA: the tracker's frame is never written, the newest is taken,
// and the cache is invalidated in whole lines after the DMA has ended.

#include "double_buffer.h"

#include <cstring>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 4;
constexpr int kBytes = kWidth * kHeight;
alignas(CACHE_LINE_BYTES) std::uint8_t memory[2][kBytes + CACHE_LINE_BYTES];

std::vector<std::pair<std::uint8_t*, std::uint32_t>> invalidated;
void invalidate(void* at, std::uint32_t bytes) {
  invalidated.emplace_back(static_cast<std::uint8_t*>(at), bytes);
}

class DoubleBuffer : public ::testing::Test {
 protected:
  void SetUp() override {
    invalidated.clear();
    ASSERT_TRUE(double_buffer_init(&buffers_, memory[0], memory[1], kWidth, kHeight, invalidate));
  }
  /// The camera ends a frame with all pixels of value `n`.
  void camera(int n) {
    std::memset(buffers_.frames[filling_], n, kBytes);
    filling_ = double_buffer_filled(&buffers_, filling_, 1000 * n);
    if (filling_ != buffers_.held) std::memset(buffers_.frames[filling_], 0xEE, kBytes);
  }
  bool take() { return double_buffer_take(&buffers_, &image_, &t_us_); }

  double_buffer buffers_{};
  int filling_ = 0;
  cairn_image image_{};
  std::int64_t t_us_ = 0;
};

TEST_F(DoubleBuffer, BuffersThatShareACacheLineAreRefused) {
  double_buffer b{};
  EXPECT_FALSE(double_buffer_init(&b, memory[0] + 1, memory[1], kWidth, kHeight, invalidate));
  EXPECT_FALSE(double_buffer_init(&b, memory[0], memory[1] + 16, kWidth, kHeight, invalidate));
  EXPECT_FALSE(double_buffer_init(&b, memory[0], memory[1], kWidth - 1, 1, invalidate));
  EXPECT_FALSE(double_buffer_init(&b, memory[0], memory[0], kWidth, kHeight, invalidate));
  EXPECT_FALSE(double_buffer_init(&b, nullptr, memory[1], kWidth, kHeight, invalidate));
  EXPECT_FALSE(double_buffer_init(&b, memory[0], memory[1], kWidth, kHeight, nullptr));
}

TEST_F(DoubleBuffer, AFrameIsTakenOnceAndItsCacheInvalidated) {
  EXPECT_FALSE(take());
  camera(1);
  ASSERT_TRUE(take());
  EXPECT_EQ(t_us_, 1000);
  EXPECT_EQ(image_.data[kBytes - 1], 1);
  ASSERT_EQ(invalidated.size(), 1U);
  EXPECT_EQ(invalidated[0].first, image_.data);
  EXPECT_EQ(invalidated[0].second, static_cast<std::uint32_t>(kBytes));
  double_buffer_release(&buffers_);
  EXPECT_FALSE(take());
}

TEST_F(DoubleBuffer, TheHeldFrameIsNeverWritten) {
  camera(1);
  ASSERT_TRUE(take());
  for (int n = 2; n < 6; ++n) {
    camera(n);
    for (int i = 0; i < kBytes; ++i) ASSERT_EQ(image_.data[i], 1) << "frame " << n;
  }
  EXPECT_EQ(buffers_.lost, 4U);
  double_buffer_release(&buffers_);
  camera(6);
  ASSERT_TRUE(take());
  EXPECT_EQ(t_us_, 6000);
  EXPECT_EQ(image_.data[0], 6);
}

TEST_F(DoubleBuffer, TheNewestFrameIsTakenAndLostOnesAreCounted) {
  for (int n = 1; n < 5; ++n) camera(n);
  ASSERT_TRUE(take());
  EXPECT_EQ(t_us_, 4000);
  EXPECT_EQ(image_.data[0], 4);
  EXPECT_EQ(buffers_.lost, 3U);
}

TEST_F(DoubleBuffer, ALineOfYuvGivesItsGreyHalf) {
  alignas(CACHE_LINE_BYTES) std::uint8_t line[2 * kWidth];
  for (int x = 0; x < kWidth; ++x) {
    line[2 * x] = static_cast<std::uint8_t>(x);
    line[2 * x + 1] = 128;
  }
  std::memset(memory[0], 0, sizeof memory[0]);
  take_yuv_line(&buffers_, 0, 2, line);
  for (int x = 0; x < kWidth; ++x) EXPECT_EQ(memory[0][2 * kWidth + x], x);
  EXPECT_EQ(memory[0][2 * kWidth - 1], 0);
  EXPECT_EQ(memory[0][3 * kWidth], 0);
  ASSERT_EQ(invalidated.size(), 1U);
  EXPECT_EQ(invalidated[0].first, line);
  EXPECT_EQ(invalidated[0].second, 2U * kWidth);
}

}  // namespace
