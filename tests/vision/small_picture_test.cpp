#include "cairn/vision/small_picture.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 120;
constexpr int kCell = 8;

/// A smooth picture, moved by (dx, dy) cells; gain and offset of its brightness.
std::vector<std::uint8_t> scene(int dx, int dy, double gain = 1.0, double offset = 0.0) {
  std::vector<std::uint8_t> pixels;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double u = x - kCell * dx;
      const double v = y - kCell * dy;
      const double value = 110.0 + 50.0 * std::sin(0.05 * u + 0.0004 * v * v) +
                           40.0 * std::cos(0.06 * v - 0.0003 * u * u);
      pixels.push_back(static_cast<std::uint8_t>(std::lround(gain * value + offset)));
    }
  }
  return pixels;
}

SmallPicture taken(const std::vector<std::uint8_t>& pixels) {
  SmallPicture picture;
  EXPECT_TRUE(picture.take({pixels.data(), kWidth, kHeight, kWidth}));
  return picture;
}

TEST(SmallPicture, HoldsTheMeansOfItsCells) {
  std::vector<std::uint8_t> pixels(kWidth * kHeight, 10);
  for (int y = kCell; y < 2 * kCell; ++y) {
    for (int x = 0; x < kCell / 2; ++x) pixels[static_cast<std::size_t>(y * kWidth + x)] = 110;
  }
  const SmallPicture picture = taken(pixels);
  EXPECT_EQ(picture.cells[0], 10);
  EXPECT_EQ(picture.cells[SmallPicture::kColumns], 60);
  SmallPicture small;
  EXPECT_FALSE(small.take({pixels.data(), SmallPicture::kColumns - 1, kHeight, kWidth}));
}

TEST(BestShift, FindsWhereThePictureMovedWhateverTheBrightness) {
  const SmallPicture before = taken(scene(0, 0));
  for (const auto& [dx, dy] : {std::pair{0, 0}, std::pair{7, -2}, std::pair{-9, 3}}) {
    const PictureShift found = best_shift(taken(scene(dx, dy, 0.7, 30.0)), before);
    EXPECT_EQ(found.dx, dx);
    EXPECT_EQ(found.dy, dy);
    EXPECT_GT(found.score, 1000.0F);
  }
}

TEST(BestShift, GivesTheSamePictureMoreThanAnother) {
  const SmallPicture before = taken(scene(0, 0));
  const float same = best_shift(taken(scene(4, 1)), before).score;
  std::vector<std::uint8_t> other = scene(0, 0);
  std::uint32_t state = 1;
  for (int cell = 0; cell < kWidth * kHeight / (kCell * kCell); ++cell) {
    state = state * 1664525U + 1013904223U;
    const int x = cell % (kWidth / kCell) * kCell;
    const int y = cell / (kWidth / kCell) * kCell;
    for (int i = 0; i < kCell * kCell; ++i) {
      other[static_cast<std::size_t>((y + i / kCell) * kWidth + x + i % kCell)] =
          static_cast<std::uint8_t>(state >> 24U);
    }
  }
  EXPECT_GT(same, 10.0F * best_shift(taken(other), before).score);
  const SmallPicture flat = taken(std::vector<std::uint8_t>(kWidth * kHeight, 90));
  EXPECT_EQ(best_shift(flat, before).score, 0.0F);
}

}  // namespace
}  // namespace cairn
