#include "cairn/vision/template_search.hpp"

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "cairn/vision/shrunk_image.hpp"

namespace cairn {
namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 80;

/// A smooth pattern without repetition nearby, moved by (dx, dy); gain and offset of its
/// brightness.
std::vector<std::uint8_t> pattern(double dx, double dy, double gain = 1.0, double offset = 0.0) {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double u = x - dx;
      const double v = y - dy;
      const double value = 110.0 + 40.0 * std::sin(0.31 * u + 0.0031 * v * v) +
                           40.0 * std::cos(0.27 * v - 0.0027 * u * u);
      pixels.push_back(static_cast<std::uint8_t>(std::lround(gain * value + offset)));
    }
  }
  return pixels;
}

ImageView view(const std::vector<std::uint8_t>& pixels) {
  return {pixels.data(), kWidth, kHeight, kWidth};
}

TEST(FindTemplate, FindsAFractionOfAPixelWhateverTheBrightness) {
  const auto before = pattern(0.0, 0.0);
  const auto after = pattern(2.4, -1.7, 0.8, 20.0);
  SmallTemplate reference;
  ASSERT_TRUE(take_template(view(before), 40, 35, reference));
  TemplateMatch match;
  ASSERT_EQ(find_template(view(after), reference, 40, 35, 5, 22938, match), Status::kOk);
  EXPECT_NEAR(match.x_q8 / 256.0, 42.4, 0.1);
  EXPECT_NEAR(match.y_q8 / 256.0, 33.3, 0.1);
  EXPECT_GT(match.correlation, 31000);
}

TEST(FindTemplate, RefusesTheBorderOfItsWindowAndOtherTexture) {
  const auto before = pattern(0.0, 0.0);
  const auto after = pattern(6.0, 0.0);
  SmallTemplate reference;
  ASSERT_TRUE(take_template(view(before), 40, 35, reference));
  TemplateMatch match;
  EXPECT_EQ(find_template(view(after), reference, 40, 35, 6, 22938, match), Status::kNotFound);
  EXPECT_EQ(find_template(view(after), reference, 40, 35, 7, 22938, match), Status::kOk);
  EXPECT_EQ(find_template(view(after), reference, 70, 60, 3, 32000, match), Status::kNotFound);
  const std::vector<std::uint8_t> flat(kWidth * kHeight, 90);
  EXPECT_EQ(find_template(view(flat), reference, 40, 35, 7, 0, match), Status::kNotFound);
}

TEST(FindTemplate, StaysInsideTheImage) {
  const auto picture = pattern(0.0, 0.0);
  SmallTemplate reference;
  EXPECT_FALSE(take_template(view(picture), 4, 40, reference));
  EXPECT_FALSE(take_template(view(picture), 40, kHeight - 5, reference));
  ASSERT_TRUE(take_template(view(picture), 6, 6, reference));
  TemplateMatch match;
  EXPECT_EQ(find_template(view(picture), reference, 2, 2, 8, 22938, match), Status::kOk);
  EXPECT_NEAR(match.x_q8, 6 * 256, 40);
  EXPECT_EQ(find_template(view(picture), reference, -900, 40, 8, 0, match), Status::kNotFound);
  constexpr int kLeast = std::numeric_limits<int>::min();
  constexpr int kMost = std::numeric_limits<int>::max();
  EXPECT_EQ(find_template(view(picture), reference, kLeast, 40, 8, 0, match), Status::kNotFound);
  EXPECT_EQ(find_template(view(picture), reference, 40, kMost, 8, 0, match), Status::kNotFound);
}

/// A picture of any size with a pattern of its own.
std::vector<std::uint8_t> noise(int width, int height) {
  std::vector<std::uint8_t> pixels;
  std::uint32_t state = 1;
  for (int i = 0; i < width * height; ++i) {
    state = state * 1664525U + 1013904223U;
    pixels.push_back(static_cast<std::uint8_t>(state >> 24U));
  }
  return pixels;
}

/// Whether each pixel of the shrunk image is the mean of `factor` by `factor` of the picture.
void expect_means(int width, int height, int factor) {
  const auto picture = noise(width, height);
  auto shrunk = std::make_unique<ShrunkImage<1280, 960>>();
  shrunk->take({picture.data(), width, height, width});
  ASSERT_EQ(shrunk->factor(), factor);
  const ImageView small = shrunk->view();
  ASSERT_EQ(small.width, width / factor);
  ASSERT_EQ(small.height, height / factor);
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      int sum = factor * factor / 2;
      for (int v = 0; v < factor; ++v) {
        for (int u = 0; u < factor; ++u) {
          sum += picture[static_cast<std::size_t>((factor * y + v) * width + factor * x + u)];
        }
      }
      ASSERT_EQ(small.row(y)[x], sum / (factor * factor)) << x << " " << y;
    }
  }
  EXPECT_FLOAT_EQ(shrunk->to_picture(shrunk->to_shrunk(30.0F)), 30.0F);
  EXPECT_FLOAT_EQ(shrunk->to_shrunk(0.5F * static_cast<float>(factor - 1)), 0.0F);
}

TEST(ShrunkImage, TakesMeansOfMorePixelsFromLargerPictures) {
  expect_means(320, 240, 2);
  expect_means(322, 241, 4);
  expect_means(640, 480, 4);
  expect_means(1280, 960, 8);
}

}  // namespace
}  // namespace cairn
