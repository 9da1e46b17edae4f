#include "cairn/vision/warped_search.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr int kWidth = 120;
constexpr int kHeight = 100;
constexpr int kLeast = 22938;  // 0.7
constexpr double kTurn = 0.3;
constexpr double kScale = 1.25;
/// Where the other camera's template point is in the image.
constexpr double kX = 63.25;
constexpr double kY = 47.5;

/// A pattern about (0, 0) without repetition nearby.
double pattern(double u, double v) {
  return 120.0 + 45.0 * std::sin(0.33 * u + 0.004 * v * v) +
         45.0 * std::cos(0.29 * v - 0.003 * u * u);
}

/// The pattern turned by kTurn, kScale times as large, about (kX, kY).
std::vector<std::uint8_t> turned_image() {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double dx = (x - kX) / kScale;
      const double dy = (y - kY) / kScale;
      const double u = std::cos(kTurn) * dx + std::sin(kTurn) * dy;
      const double v = -std::sin(kTurn) * dx + std::cos(kTurn) * dy;
      pixels.push_back(static_cast<std::uint8_t>(std::lround(pattern(u, v))));
    }
  }
  return pixels;
}

SmallTemplate upright_template() {
  SmallTemplate out;
  for (int y = 0; y < SmallTemplate::kSide; ++y) {
    for (int x = 0; x < SmallTemplate::kSide; ++x) {
      out.pixels[y * SmallTemplate::kSide + x] = static_cast<std::uint8_t>(
          std::lround(pattern(x - SmallTemplate::kHalf, y - SmallTemplate::kHalf)));
    }
  }
  return out;
}

PatchWarp warp_of(double turn, double scale) {
  const auto q16 = [](double v) { return static_cast<std::int32_t>(std::lround(65536.0 * v)); };
  return {q16(scale * std::cos(turn)), q16(-scale * std::sin(turn)), q16(scale * std::sin(turn)),
          q16(scale * std::cos(turn))};
}

/// GIVEN an image that shows a template turned and larger.
class FindWarpedTemplate : public ::testing::Test {
 protected:
  static int q8(double v) { return static_cast<int>(std::lround(256.0 * v)); }
  ImageView view() const { return {image_.data(), kWidth, kHeight, kWidth}; }
  Status seek(const PatchWarp& warp, double from_x, double from_y, int radius) {
    const SmallTemplate reference = upright_template();
    return radius > kMaxWarpedRadius
               ? find_warped_template_widely(view(), reference, warp, q8(from_x), q8(from_y),
                                             radius, kLeast, match_)
               : find_warped_template(view(), reference, warp, q8(from_x), q8(from_y), radius,
                                      kLeast, match_);
  }
  void expect_found() const {
    EXPECT_NEAR(match_.x_q8 / 256.0, kX, 0.3);
    EXPECT_NEAR(match_.y_q8 / 256.0, kY, 0.3);
  }

  std::vector<std::uint8_t> image_ = turned_image();
  TemplateMatch match_;
};

TEST_F(FindWarpedTemplate, FindsItThroughTheWarpAlone) {
  ASSERT_EQ(seek(warp_of(kTurn, kScale), kX + 2.3, kY - 1.6, 5), Status::kOk);
  expect_found();
  EXPECT_GT(match_.correlation, 31000);
  EXPECT_EQ(seek(warp_of(-1.2, 0.7), kX, kY, 5), Status::kNotFound);
}

TEST_F(FindWarpedTemplate, FindsItFromFarByEverySecondPlace) {
  for (const int radius : {15, 16}) {
    match_ = {};
    ASSERT_EQ(seek(warp_of(kTurn, kScale), kX + 14.0, kY - 9.0, radius), Status::kOk) << radius;
    expect_found();
  }
}

TEST_F(FindWarpedTemplate, RefusesWhatIsOutsideTheImageAndWildWarps) {
  EXPECT_EQ(seek(warp_of(kTurn, kScale), -30.0, -30.0, 5), Status::kNotFound);
  EXPECT_EQ(seek(warp_of(kTurn, kScale), 8388607.0, -8388607.0, 5), Status::kNotFound);
  EXPECT_EQ(seek(warp_of(kTurn, kScale), 8388607.0, -8388607.0, 16), Status::kNotFound);
  EXPECT_EQ(seek(warp_of(0.0, 5.0), kX, kY, 5), Status::kNotFound);
  EXPECT_EQ(seek(warp_of(0.0, 5.0), kX, kY, 16), Status::kNotFound);
  EXPECT_EQ(match_.correlation, 0) << "untouched";
}

}  // namespace
}  // namespace cairn
