#include "host_sim/experiments/faults/pictures.hpp"

#include <algorithm>

#include <opencv2/imgproc.hpp>

#include "cairn/numeric/random.hpp"

namespace cairn::host {

cv::Mat flat(const cv::Mat& picture, int grey) {
  return cv::Mat(picture.size(), CV_8UC1, cv::Scalar(grey));
}

cv::Mat noise(const cv::Mat& picture, std::uint64_t seed) {
  Random random(seed);
  cv::Mat result(picture.size(), CV_8UC1);
  for (int y = 0; y < result.rows; ++y) {
    std::uint8_t* row = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < result.cols; ++x) row[x] = static_cast<std::uint8_t>(random.next() >> 24U);
  }
  return result;
}

cv::Mat grain(const cv::Mat& picture, std::uint64_t seed) {
  Random random(seed);
  cv::Mat result = picture.clone();
  for (int y = 0; y < result.rows; ++y) {
    std::uint8_t* row = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < result.cols; ++x) {
      const int off = static_cast<int>((random.next() >> 24U) % 7U) - 3;
      row[x] = static_cast<std::uint8_t>(std::clamp(row[x] + off, 0, 255));
    }
  }
  return result;
}

cv::Mat dimmed(const cv::Mat& picture, double factor) {
  cv::Mat result;
  picture.convertTo(result, CV_8UC1, factor);
  return result;
}

cv::Mat checkerboard(const cv::Mat& picture, int square_px) {
  cv::Mat result(picture.size(), CV_8UC1);
  for (int y = 0; y < result.rows; ++y) {
    std::uint8_t* row = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < result.cols; ++x) {
      row[x] = (x / square_px + y / square_px) % 2 == 0 ? 40 : 210;
    }
  }
  return result;
}

cv::Mat tiled(const cv::Mat& picture, int tile_px) {
  const int size = std::min({tile_px, picture.cols, picture.rows});
  cv::Mat result(picture.size(), CV_8UC1);
  for (int y = 0; y < result.rows; ++y) {
    std::uint8_t* row = result.ptr<std::uint8_t>(y);
    const std::uint8_t* from = picture.ptr<std::uint8_t>(picture.rows / 3 + y % size / 2);
    for (int x = 0; x < result.cols; ++x) row[x] = from[x % size];
  }
  return result;
}

cv::Mat mirrored(const cv::Mat& picture) {
  cv::Mat result;
  cv::flip(picture, result, 1);
  return result;
}

cv::Mat torn(const cv::Mat& picture, const cv::Mat& other) {
  cv::Mat result = picture.clone();
  const cv::Rect below(0, picture.rows / 2, picture.cols, picture.rows - picture.rows / 2);
  other(below).copyTo(result(below));
  return result;
}

cv::Mat skewed(const cv::Mat& picture) {
  cv::Mat result(picture.size(), CV_8UC1);
  for (int y = 0; y < result.rows; ++y) {
    const std::uint8_t* from = picture.ptr<std::uint8_t>(y);
    std::uint8_t* row = result.ptr<std::uint8_t>(y);
    for (int x = 0; x < result.cols; ++x) row[x] = from[(x + y) % result.cols];
  }
  return result;
}

cv::Mat flipped_bits(const cv::Mat& picture, int count, std::uint64_t seed) {
  Random random(seed);
  cv::Mat result = picture.clone();
  const auto below = [&random](int limit) {
    return static_cast<int>(random.next() % static_cast<std::uint32_t>(limit));
  };
  for (int i = 0; i < count; ++i) {
    const int y = below(result.rows);
    std::uint8_t& pixel = result.at<std::uint8_t>(y, below(result.cols));
    pixel = static_cast<std::uint8_t>(pixel ^ (1U << static_cast<unsigned>(below(8))));
  }
  return result;
}

cv::Mat half_black(const cv::Mat& picture) {
  cv::Mat result = picture.clone();
  result(cv::Rect(0, 0, picture.cols / 2, picture.rows)).setTo(0);
  return result;
}

cv::Mat dirty(const cv::Mat& picture) {
  Random random(7);
  cv::Mat result = picture.clone();
  for (int i = 0; i < 12; ++i) {
    const int x = static_cast<int>(random.next() % static_cast<std::uint32_t>(picture.cols));
    const int y = static_cast<int>(random.next() % static_cast<std::uint32_t>(picture.rows));
    cv::circle(result, {x, y}, picture.cols / 40, cv::Scalar(20), cv::FILLED);
  }
  return result;
}

}  // namespace cairn::host
