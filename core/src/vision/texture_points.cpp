#include "cairn/vision/texture_points.hpp"

namespace cairn {
namespace {

constexpr int kMost = 32 / 2 + 2;  // gradients of a row of a cell, one more on each side

/// Products of the gradients at every second pixel.
struct Products {
  std::int32_t xx = 0;
  std::int32_t xy = 0;
  std::int32_t yy = 0;

  Products() = default;
  Products(const std::uint8_t* p, std::ptrdiff_t stride) {
    const std::int32_t dx = p[1] - p[-1];
    const std::int32_t dy = p[stride] - p[-stride];
    xx = dx * dx;
    xy = dx * dy;
    yy = dy * dy;
  }
  Products operator+(const Products& other) const {
    Products sum;
    sum.xx = xx + other.xx;
    sum.xy = xy + other.xy;
    sum.yy = yy + other.yy;
    return sum;
  }
};

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
  std::int32_t limit = 0;  // a score is below both sums of squares
  const int count = size / 2;
  const Rect inside{margin, margin, image.width - margin, image.height - margin};
  // Gradients of the last three rows, of which the present one is summed over three columns.
  Products rows[3][kMost];
  const bool whole = x0 >= 3 && x0 + size + 1 < image.width;
  for (int row = 0; row < count + 2; ++row) {
    const int y = y0 + 2 * (row - 1);
    Products* const sums = rows[row % 3];
    const bool row_inside = y >= 1 && y < image.height - 1;
    const std::uint8_t* const pixels = image.row(row_inside ? y : 0);
    Products left;
    Products middle;
    for (int column = 0; column < count + 2; ++column) {
      const int x = x0 + 2 * (column - 1);
      const bool in_image = row_inside && (whole || (x >= 1 && x < image.width - 1));
      const Products right = in_image ? Products(pixels + x, image.stride) : Products();
      if (column >= 2) sums[column - 1] = left + middle + right;
      left = middle;
      middle = right;
    }
    const int centre = y - 2;
    if (row < 2 || centre < inside.y0 || centre >= inside.y1) continue;
    for (int column = 1; column <= count; ++column) {
      const int x = x0 + 2 * (column - 1);
      if (x < inside.x0 || x >= inside.x1) continue;
      const Products sum = rows[0][column] + rows[1][column] + rows[2][column];
      if ((sum.xx < sum.yy ? sum.xx : sum.yy) <= limit) continue;
      const float score = score_of(sum);
      if (score > best.score) {
        best = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(centre), score};
        limit = static_cast<std::int32_t>(score);
      }
    }
  }
  return best;
}

float texture_of(const ImageView& image, int x0, int y0, int size) {
  const Rect square =
      intersect({x0, y0, x0 + size, y0 + size}, {1, 1, image.width - 1, image.height - 1});
  Products sum;
  for (int y = square.y0; y < square.y1; y += 2) {
    const std::uint8_t* const row = image.row(y);
    for (int x = square.x0; x < square.x1; x += 2) sum = sum + Products(row + x, image.stride);
  }
  return score_of(sum);
}

}  // namespace cairn
