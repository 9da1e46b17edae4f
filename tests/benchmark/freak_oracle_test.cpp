// Descriptors against OpenCV's own FREAK: every coordinate up to 4,096, and many textures.

#include <cstring>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/xfeatures2d.hpp>

#include "cairn/numeric/random.hpp"
#include "cairn/vision/freak.hpp"

#include "freak_sum.hpp"

namespace cairn {
namespace {

cv::Mat noise(int width, int height, int block, std::uint64_t seed) {
  Random random(seed);
  cv::Mat image(height, width, CV_8U);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const bool first = x % block == 0 && y % block == 0;
      image.at<std::uint8_t>(y, x) = first ? static_cast<std::uint8_t>(random.below(256))
                                           : image.at<std::uint8_t>(y - y % block, x - x % block);
    }
  }
  return image;
}

/// Describes the points by both; how many there were, or -1 when any differs.
int compare(const cv::Mat& image, const std::vector<cv::KeyPoint>& points, bool oriented) {
  std::vector<cv::KeyPoint> kept = points;
  cv::Mat theirs;
  cv::xfeatures2d::FREAK::create(oriented)->compute(image, kept, theirs);
  const ImageView view{image.data, image.cols, image.rows, static_cast<int>(image.step)};
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const int x = static_cast<int>(kept[i].pt.x);
    const int y = static_cast<int>(kept[i].pt.y);
    Descriptor ours;
    std::uint8_t bin = 0;
    const Status status = oriented ? describe_freak(view, x, y, ours, bin)
                                   : describe_freak(view, x, y, FreakPose{}, ours);
    if (!ok(status) ||
        std::memcmp(theirs.ptr(static_cast<int>(i)), ours.bytes, sizeof ours.bytes) != 0) {
      ADD_FAILURE() << "differs at " << x << ", " << y;
      return -1;
    }
  }
  return static_cast<int>(kept.size());
}

TEST(FreakOracle, EqualAtEveryCoordinate) {
  std::vector<cv::KeyPoint> along_x;
  std::vector<cv::KeyPoint> along_y;
  for (int k = 0; k < 4096; ++k) {
    for (const int across : {24, 37, 40}) {
      along_x.emplace_back(static_cast<float>(k), static_cast<float>(across), 7.0F);
      along_y.emplace_back(static_cast<float>(across), static_cast<float>(k), 7.0F);
    }
  }
  for (const int block : {1, 3}) {
    for (const bool oriented : {true, false}) {
      EXPECT_EQ(compare(noise(4096, 64, block, 1), along_x, oriented), 3 * (4096 - 47));
      EXPECT_EQ(compare(noise(64, 4096, block, 2), along_y, oriented), 3 * (4096 - 47));
    }
  }
}

TEST(FreakOracle, SumOfAllCoordinatesIsThatOfTheTargets) {
  using namespace cairn_test;
  const cv::Mat wide = noise(kLong, kShort, 1, kNoiseSeed);
  const cv::Mat tall(kLong, kShort, CV_8U, wide.data);
  std::vector<cv::KeyPoint> points[2];
  for (int k = kMargin; k <= kLong - kMargin; ++k) {
    points[0].emplace_back(static_cast<float>(k), static_cast<float>(across(k)), 7.0F);
    points[1].emplace_back(static_cast<float>(across(k)), static_cast<float>(k), 7.0F);
  }
  cv::Mat rows[2][2];
  for (const int oriented : {0, 1}) {
    const auto freak = cv::xfeatures2d::FREAK::create(oriented == 1);
    freak->compute(wide, points[0], rows[oriented][0]);
    freak->compute(tall, points[1], rows[oriented][1]);
  }
  Sum sum;
  for (int i = 0; i < rows[0][0].rows; ++i) {
    for (const int oriented : {1, 0}) {
      for (const cv::Mat& descriptors : rows[oriented]) sum.add(descriptors.ptr(i), 64);
    }
  }
  EXPECT_EQ(sum.value(), kFreakSumOfAllCoordinates);
}

TEST(FreakOracle, EqualOnManyTextures) {
  int described = 0;
  for (int block = 1; block <= 16; ++block) {
    const cv::Mat image = noise(320, 240, block, 10 + static_cast<unsigned>(block));
    std::vector<cv::KeyPoint> points;
    for (int y = 24; y <= 216; y += 5) {
      for (int x = 24; x <= 296; x += 3) {
        points.emplace_back(static_cast<float>(x), static_cast<float>(y), 7.0F);
      }
    }
    described += compare(image, points, true);
  }
  EXPECT_GT(described, 50000);
}

}  // namespace
}  // namespace cairn
