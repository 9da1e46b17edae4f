#include "cairn/vision/freak.hpp"

#include <cmath>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"
#include "cairn/vision/hamming.hpp"

#include "grey_image.hpp"

namespace cairn {
namespace {

test::GreyImage wave_image(int width, int height) {
  test::GreyImage image{width, height, {}};
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.pixels.push_back(static_cast<std::uint8_t>((x * x / 3 + 5 * y + x * y / 7) & 255));
    }
  }
  return image;
}

TEST(Freak, MarginIsTheNearestDescribablePoint) {
  EXPECT_EQ(freak_margin(0), 24);
  EXPECT_EQ(freak_margin(24), 65);
  EXPECT_EQ(freak_margin(-3), 24);
  EXPECT_EQ(freak_margin(99), 65);
  for (int scale = 0; scale <= 24; ++scale) {
    const int margin = freak_margin(scale);
    // No byte around the image belongs to it: a sanitizer sees every read outside.
    const test::GreyImage image = wave_image(2 * margin + 1, 2 * margin + 3);
    Descriptor d;
    const FreakPose pose{37, static_cast<std::uint8_t>(scale)};
    for (const int x : {margin, margin + 1}) {
      for (const int y : {margin, margin + 3}) {
        EXPECT_EQ(describe_freak(image.view(), x, y, pose, d), Status::kOk);
      }
    }
    EXPECT_EQ(describe_freak(image.view(), margin - 1, margin, pose, d), Status::kOutOfView);
    EXPECT_EQ(describe_freak(image.view(), margin + 2, margin, pose, d), Status::kOutOfView);
    EXPECT_EQ(describe_freak(image.view(), margin, margin - 1, pose, d), Status::kOutOfView);
    EXPECT_EQ(describe_freak(image.view(), margin, margin + 4, pose, d), Status::kOutOfView);
  }
}

TEST(Freak, ErrorsLeaveTheOutputsAlone) {
  const test::GreyImage image = wave_image(60, 60);
  Descriptor d;
  d.bytes[5] = 42;
  std::uint8_t bin = 7;
  EXPECT_EQ(describe_freak(image.view(), 3, 30, d, bin), Status::kOutOfView);
  EXPECT_EQ(describe_freak(ImageView{}, 30, 30, d, bin), Status::kInvalidArgument);
  EXPECT_EQ(describe_freak(image.view(), 30, 30, FreakPose{0, 25}, d), Status::kInvalidArgument);
  EXPECT_EQ(describe_freak(image.view(), -2000000000, 30, FreakPose{}, d), Status::kOutOfView);
  EXPECT_EQ(d.bytes[5], 42);
  EXPECT_EQ(bin, 7);
}

TEST(Freak, EqualPixelsGiveAllOnes) {
  const test::GreyImage image{60, 60, std::vector<std::uint8_t>(3600, 200)};
  Descriptor d;
  std::uint8_t bin = 9;
  ASSERT_EQ(describe_freak(image.view(), 30, 30, d, bin), Status::kOk);
  EXPECT_EQ(bin, 0);
  for (const std::uint8_t byte : d.bytes) EXPECT_EQ(byte, 255);
}

TEST(Hamming, CountsDifferingBits) {
  Random random(5);
  Descriptor a;
  for (auto& byte : a.bytes) byte = static_cast<std::uint8_t>(random.below(256));
  EXPECT_EQ(hamming_distance(a, a), 0);
  Descriptor b = a;
  for (int bit = 0; bit < 512; ++bit) {
    b.bytes[bit / 8] = static_cast<std::uint8_t>(b.bytes[bit / 8] ^ (1 << bit % 8));
    ASSERT_EQ(hamming_distance(a, b), bit + 1);
  }
}

TEST(Hamming, TiesKeepTheLowerIndexAndFillTheSecond) {
  Descriptor query;
  Descriptor candidates[4];
  for (auto& d : candidates) d.bytes[0] = 1;
  candidates[0].bytes[1] = 255;
  const HammingMatch match = match_hamming(query, {candidates, 4});
  EXPECT_EQ(match.index, 1);
  EXPECT_EQ(match.distance, 1);
  EXPECT_EQ(match.second_distance, 1);
  const HammingMatch one = match_hamming(query, {candidates, 1});
  EXPECT_EQ(one.index, 0);
  EXPECT_EQ(one.distance, 9);
  EXPECT_EQ(one.second_distance, 513);
  EXPECT_EQ(match_hamming(query, {}).index, -1);
}

TEST(Hamming, CascadeLeavesOutWhatDiffersEarly) {
  Descriptor query;
  Descriptor candidates[3];
  candidates[0].bytes[3] = 0x1F;   // 5 of the first 128 bits
  candidates[1].bytes[60] = 0xFF;  // 8 later ones
  candidates[2].bytes[16] = 0x7F;  // 7 just beyond the prefix
  EXPECT_EQ(match_hamming(query, {candidates, 3}).index, 0);
  EXPECT_EQ(match_hamming(query, {candidates, 3}, 5).index, 0);
  const HammingMatch match = match_hamming(query, {candidates, 3}, 4);
  EXPECT_EQ(match.index, 2);
  EXPECT_EQ(match.distance, 7);
  EXPECT_EQ(match.second_distance, 8);
  EXPECT_FALSE(match.distinct(4, 5));
  EXPECT_TRUE(match.distinct(9, 10));
  EXPECT_EQ(match_hamming(query, {candidates, 1}, 4).index, -1);
  EXPECT_FALSE(match_hamming(query, {candidates, 1}, 4).distinct(1, 1));
}

TEST(Hamming, WindowGatesTheCandidates) {
  Descriptor query;
  Descriptor candidates[4];
  candidates[1].bytes[0] = 1;
  candidates[2].bytes[0] = 3;
  candidates[3].bytes[0] = 7;
  const Corner corners[4] = {{9, 20, 1}, {10, 20, 1}, {19, 29, 1}, {20, 29, 1}};
  const HammingMatch match =
      match_hamming_in({10, 20, 20, 30}, query, {corners, 4}, {candidates, 4});
  EXPECT_EQ(match.index, 1);
  EXPECT_EQ(match.distance, 1);
  EXPECT_EQ(match.second_distance, 2);
  EXPECT_EQ(match_hamming_in({30, 20, 40, 30}, query, {corners, 4}, {candidates, 4}).index, -1);
}

TEST(Hamming, CrossMatchKeepsMutualBest) {
  Descriptor queries[3];
  Descriptor candidates[2];
  queries[1].bytes[0] = 1;     // nearest to candidate 0 as well, but not as near as query 0
  queries[2].bytes[0] = 0xFF;  // nearest to candidate 1
  candidates[1].bytes[0] = 0x7F;
  HammingMatch matches[3];
  HammingMatch scratch[2];
  cross_match_hamming({queries, 3}, {candidates, 2}, kNoPrefixLimit, matches, scratch);
  EXPECT_EQ(matches[0].index, 0);
  EXPECT_EQ(matches[1].index, -1);
  EXPECT_EQ(matches[1].distance, 1);
  EXPECT_EQ(matches[2].index, 1);
  EXPECT_EQ(matches[2].distance, 1);
  EXPECT_EQ(matches[2].second_distance, 8);
}

TEST(Freak, FullPrecisionOrientationIsFiner) {
  // A ramp of known direction: the full orientation is near its bin, the cut one further off.
  int cut_error = 0;
  int full_error = 0;
  for (int bin = 0; bin < 256; bin += 3) {
    const double angle = bin * 6.283185307179586 / 256;
    test::GreyImage image{64, 64, {}};
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const double value = 128 + std::cos(angle) * (x - 32) + std::sin(angle) * (y - 32);
        image.pixels.push_back(static_cast<std::uint8_t>(std::lround(value)));
      }
    }
    Descriptor d;
    std::uint8_t cut = 0;
    std::uint8_t full = 0;
    ASSERT_EQ(describe_freak(image.view(), 32, 32, d, cut), Status::kOk);
    ASSERT_EQ(describe_freak(image.view(), 32, 32, d, full, FreakOrientation::kFull), Status::kOk);
    const int error = std::abs(static_cast<std::int8_t>(full - bin));
    EXPECT_LE(error, 2) << bin;
    full_error += error;
    cut_error += std::abs(static_cast<std::int8_t>(cut - bin));
  }
  EXPECT_LT(full_error, cut_error);
}

}  // namespace
}  // namespace cairn
