#include "cairn/vision/texture_points.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace cairn {
namespace {

constexpr int kWidth = 128;
constexpr int kHeight = 96;

/// Bright squares on a dark ground, at (20, 20) and (84, 52), 14 pixels wide; and a long edge.
std::vector<std::uint8_t> squares() {
  std::vector<std::uint8_t> pixels(kWidth * kHeight, 40);
  const auto fill = [&](int x0, int y0, int x1, int y1, std::uint8_t grey) {
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) pixels[static_cast<std::size_t>(y * kWidth + x)] = grey;
    }
  };
  fill(20, 20, 34, 34, 200);
  fill(84, 52, 98, 66, 150);
  fill(0, 80, kWidth, kHeight, 220);
  return pixels;
}

using Points = TexturePoints<kWidth, kHeight>;

/// Rates the open cells, and seeks the best point of each.
void find(Points& points, const std::vector<std::uint8_t>& picture, int margin) {
  const ImageView image{picture.data(), kWidth, kHeight, kWidth};
  points.rate(image);
  for (int i = 0; i < points.cells(); ++i) {
    if (points.is_open(i)) points.refine(i, image, margin);
  }
}
TexturePoint best(const Points& points) {
  const int cell = points.best();
  return cell < 0 ? TexturePoint() : points[cell];
}

TEST(TexturePoints, FindsCornersAndNoEdgesTheStrongestFirst) {
  const auto picture = squares();
  static Points points;
  points.begin(kWidth, kHeight);
  find(points, picture, 8);
  const float strongest = best(points).score;
  int first = 0;
  int second = 0;
  for (int i = 0; i < 20; ++i) {
    const TexturePoint point = best(points);
    if (point.score < 0.01F * strongest) break;
    const bool bright = point.x < 40 && point.y < 40;
    EXPECT_TRUE(bright || (point.x > 80 && point.x < 102 && point.y > 48 && point.y < 70))
        << point.x << " " << point.y;
    EXPECT_TRUE(bright ? second == 0 : first > 0);
    ++(bright ? first : second);
    points.close(point.x, point.y, 6.0F);
  }
  EXPECT_EQ(first, 4);
  EXPECT_EQ(second, 4);
}

TEST(TexturePoints, LeavesOutWhatIsKnownAndTheBorder) {
  const auto picture = squares();
  static Points points;
  points.begin(kWidth, kHeight);
  const int all = points.open_cells();
  points.close(27.0F, 27.0F, 24.0F);
  EXPECT_LT(points.open_cells(), all);
  find(points, picture, 8);
  EXPECT_GT(best(points).x, 70);
  points.begin(kWidth, kHeight);
  find(points, picture, 40);
  const TexturePoint inside = best(points);
  EXPECT_TRUE(inside.score == 0.0F || (inside.x >= 40 && inside.x < kWidth - 40));
}

TEST(TexturePoints, RatesCellsByTheTextureOfTheWhole) {
  const auto picture = squares();
  static Points points;
  points.begin(kWidth, kHeight);
  points.rate({picture.data(), kWidth, kHeight, kWidth});
  const TexturePoint rated = best(points);
  EXPECT_EQ(rated.x % Points::kCell, Points::kCell / 2);
  EXPECT_TRUE(rated.x < 48 && rated.y < 48) << "the brighter square";
  const TexturePoint edge = points[(kHeight / Points::kCell - 1) * (kWidth / Points::kCell) + 3];
  EXPECT_EQ(edge.score, 0.0F) << "an edge alone is no texture";
}

TEST(TexturePoints, FlatPicturesHaveNone) {
  const std::vector<std::uint8_t> flat(kWidth * kHeight, 77);
  static Points points;
  points.begin(kWidth, kHeight);
  find(points, flat, 3);
  EXPECT_EQ(best(points).score, 0.0F);
}

}  // namespace
}  // namespace cairn
