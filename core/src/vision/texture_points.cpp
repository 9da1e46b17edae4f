#include "cairn/vision/texture_points.hpp"

namespace cairn {
namespace {

constexpr int kMost = 32 / 2 + 2;  // gradients of a row of a cell, one more on each side

/// Products of the gradients at every second pixel.
struct Products {
  std::int32_t xx = 0;
  std::int32_t xy = 0;
  std::int32_t yy = 0;

  void add(const Products& other) {
    xx += other.xx;
    xy += other.xy;
    yy += other.yy;
  }
};

Products products_at(const ImageView& image, int x, int y) {
  const std::uint8_t* const p = image.row(y) + x;
  const std::int32_t dx = p[1] - p[-1];
  const std::int32_t dy = p[image.stride] - p[-image.stride];
  return {dx * dx, dx * dy, dy * dy};
}

/// Noble's measure of a corner, 0 where there is no texture at all.
float score_of(const Products& sum) {
  const auto a = static_cast<float>(sum.xx);
  const auto b = static_cast<float>(sum.xy);
  const auto c = static_cast<float>(sum.yy);
  const float determinant = a * c - b * b;
  return determinant > 0.0F ? determinant / (a + c) : 0.0F;
}

}  // namespace

TexturePoint best_texture(const ImageView& image, int x0, int y0, int size, int margin) {
  TexturePoint best;
  const int count = size / 2;
  const Rect inside{margin, margin, image.width - margin, image.height - margin};
  // Sums over three columns of the last three rows of gradients.
  Products rows[3][kMost];
  for (int row = 0; row < count + 2; ++row) {
    const int y = y0 + 2 * (row - 1);
    Products line[kMost];
    for (int column = 0; column < count + 2; ++column) {
      const int x = x0 + 2 * (column - 1);
      if (x >= 1 && y >= 1 && x < image.width - 1 && y < image.height - 1) {
        line[column] = products_at(image, x, y);
      }
    }
    Products* const sums = rows[row % 3];
    for (int column = 1; column <= count; ++column) {
      sums[column] = line[column - 1];
      sums[column].add(line[column]);
      sums[column].add(line[column + 1]);
    }
    const int centre = y - 2;
    if (row < 2 || centre < inside.y0 || centre >= inside.y1) continue;
    for (int column = 1; column <= count; ++column) {
      const int x = x0 + 2 * (column - 1);
      if (x < inside.x0 || x >= inside.x1) continue;
      Products sum = rows[0][column];
      sum.add(rows[1][column]);
      sum.add(rows[2][column]);
      const float score = score_of(sum);
      if (score > best.score) {
        best = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(centre), score};
      }
    }
  }
  return best;
}

}  // namespace cairn
