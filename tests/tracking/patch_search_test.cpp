#include "cairn/tracking/patch_search.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "cairn/numeric/random.hpp"

namespace cairn {
namespace {

/// GIVEN an image of smooth noise, in which every place is unlike the others, and the patch of one.
class SearchOfAPatch : public ::testing::Test {
 protected:
  static constexpr int kWidth = 120;
  static constexpr int kHeight = 100;
  static constexpr int kX = 60;
  static constexpr int kY = 50;

  SearchOfAPatch() : pixels_(kWidth * kHeight) {
    Random random(11);
    std::vector<float> noise(pixels_.size());
    for (float& value : noise) value = static_cast<float>(random.below(1001)) / 1000.0F;
    for (int y = 1; y < kHeight - 1; ++y) {
      for (int x = 1; x < kWidth - 1; ++x) {
        float sum = 0.0F;
        for (int dy = -1; dy <= 1; ++dy) {
          for (int dx = -1; dx <= 1; ++dx) {
            sum += noise[static_cast<std::size_t>((y + dy) * kWidth + x + dx)];
          }
        }
        pixels_[static_cast<std::size_t>(y * kWidth + x)] = static_cast<std::uint8_t>(sum * 28.0F);
      }
    }
    EXPECT_TRUE(ok(extract_patch(image(), kX * 256, kY * 256, patch_)));
    expect_at(kX, kY, 4.0F);
  }
  ImageView image() const { return {pixels_.data(), kWidth, kHeight, kWidth}; }
  void expect_at(float x, float y, float sigma_px) {
    prediction_.pixel = Vector2<float>(x, y);
    prediction_.covariance = sigma_px * sigma_px * Matrix2<float>::Identity();
  }
  Status search() { return search_patch(image(), prediction_, patch_, warp_, parameters_, pixel_); }
  float error() const { return (pixel_ - Vector2<float>(kX, kY)).norm(); }

  std::vector<std::uint8_t> pixels_;
  Patch patch_;
  PatchWarp warp_;
  PatchSearchParameters parameters_;
  PixelPrediction<float> prediction_;
  Vector2<float> pixel_ = Vector2<float>(-1.0F, -1.0F);
};

TEST_F(SearchOfAPatch, FindsItAnywhereInTheEllipse) {
  for (const float dx : {-8.0F, -3.0F, 0.0F, 5.0F, 8.0F}) {
    for (const float dy : {-7.0F, 0.0F, 1.0F, 7.0F}) {
      expect_at(kX + dx, kY + dy, 4.0F);
      ASSERT_EQ(search(), Status::kOk) << dx << ' ' << dy;
      EXPECT_LT(error(), 0.1F) << dx << ' ' << dy;
    }
  }
}

TEST_F(SearchOfAPatch, LooksNowhereElse) {
  expect_at(kX + 16.0F, kY, 4.0F);  // 4 sigma
  EXPECT_EQ(search(), Status::kNotFound);
  prediction_.covariance(0, 0) = 36.0F;
  EXPECT_EQ(search(), Status::kOk);
  // An ellipse that is narrow in the direction of the feature.
  prediction_.covariance << 4.0F, 0.0F, 0.0F, 36.0F;
  EXPECT_EQ(search(), Status::kNotFound);
}

TEST_F(SearchOfAPatch, DoesNotMindBrightnessAndContrast) {
  for (std::uint8_t& pixel : pixels_) pixel = static_cast<std::uint8_t>(60 + pixel / 2);
  ASSERT_EQ(search(), Status::kOk);
  EXPECT_LT(error(), 0.1F);
}

/// The patch was seen by a camera rolled by 30 degrees.
TEST_F(SearchOfAPatch, FindsAWarpedView) {
  constexpr int kCos = 222;  // Q8
  constexpr int kSin = 128;
  std::uint8_t* out = patch_.pixels;
  for (int y = -(Patch::kSize / 2); y <= Patch::kSize / 2; ++y) {
    for (int x = -(Patch::kSize / 2); x <= Patch::kSize / 2; ++x) {
      Patch there;
      ASSERT_TRUE(ok(extract_patch(image(), kX * 256 + kCos * x - kSin * y,
                                   kY * 256 + kSin * x + kCos * y, there)));
      *out++ = there.pixels[Patch::kSize * Patch::kSize / 2];
    }
  }
  expect_at(kX + 3.0F, kY - 2.0F, 3.0F);
  EXPECT_EQ(search(), Status::kNotFound);
  warp_ = {kCos << 8, -(kSin << 8), kSin << 8, kCos << 8};
  ASSERT_EQ(search(), Status::kOk);
  EXPECT_LT(error(), 0.2F);
}

TEST_F(SearchOfAPatch, LeavesThePixelWhereItSaysWhy) {
  prediction_.covariance << 1.0F, 2.0F, 2.0F, 1.0F;
  EXPECT_EQ(search(), Status::kSingular);
  expect_at(kX, kY, 4.0F);
  warp_.xx = 0;
  EXPECT_EQ(search(), Status::kDegenerate);
  warp_ = PatchWarp();
  for (std::uint8_t& pixel : patch_.pixels) pixel = 99;
  EXPECT_EQ(search(), Status::kDegenerate);
  EXPECT_EQ(pixel_, Vector2<float>(-1.0F, -1.0F));
}

TEST_F(SearchOfAPatch, StaysInsideTheImage) {
  expect_at(-30.0F, -30.0F, 4.0F);
  EXPECT_EQ(search(), Status::kNotFound);
  expect_at(1.0F, 1.0F, 8.0F);
  EXPECT_NE(search(), Status::kOk);
  expect_at(kWidth - 1.0F, kHeight - 1.0F, 8.0F);
  EXPECT_NE(search(), Status::kOk);
}

/// A point of unknown depth: its ellipse is long and thin, along the epipolar line.
TEST_F(SearchOfAPatch, FollowsALongThinEllipse) {
  parameters_.max_half_window_px = PatchSearchParameters::kMaxHalfWindow;
  expect_at(kX - 40.0F, kY - 20.0F, 1.0F);
  const Vector2<float> along(20.0F, 10.0F);
  prediction_.covariance += along * along.transpose();
  ASSERT_EQ(search(), Status::kOk);
  EXPECT_LT(error(), 0.1F);
  PatchWindow window;
  ASSERT_TRUE(make_patch_window(prediction_, parameters_, window));
  EXPECT_LT(window.places, 300) << "its area, not that of the rectangle around it";
}

TEST_F(SearchOfAPatch, CutsAnEllipseThatIsTooLarge) {
  parameters_.max_half_window_px = PatchSearchParameters::kMaxHalfWindow;
  expect_at(kX, kY, 60.0F);
  PatchWindow window;
  ASSERT_TRUE(make_patch_window(prediction_, parameters_, window));
  EXPECT_LE(window.places, PatchSearchParameters::kMaxPlaces);
  EXPECT_LT(window.gate, parameters_.gate);
  ASSERT_EQ(search(), Status::kOk);
  EXPECT_LT(error(), 0.1F);
}

}  // namespace
}  // namespace cairn
