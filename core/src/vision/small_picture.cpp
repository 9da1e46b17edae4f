#include "cairn/vision/small_picture.hpp"

namespace cairn {
namespace {

constexpr int kColumns = SmallPicture::kColumns;
constexpr int kRows = SmallPicture::kRows;
constexpr int kLeastCells = 2 * kColumns * kRows / 5;

/// Mean over a cell.
std::uint8_t mean_of(const ImageView& image, int x, int y, int width, int height) {
  std::int32_t sum = 0;
  for (int row = y; row < y + height; ++row) {
    const std::uint8_t* const pixels = image.row(row) + x;
    for (int i = 0; i < width; ++i) sum += pixels[i];
  }
  return static_cast<std::uint8_t>(sum / (width * height));
}

/// First cell of the earlier picture that has one in the present one, `shift` away.
int first_of(int shift) {
  return shift < 0 ? -shift : 0;
}

float score_at(const SmallPicture& present, const SmallPicture& before, int dx, int dy) {
  const int columns = kColumns - (dx < 0 ? -dx : dx);
  const int rows = kRows - (dy < 0 ? -dy : dy);
  std::int32_t a = 0;
  std::int32_t b = 0;
  std::int32_t aa = 0;
  std::int32_t bb = 0;
  std::int32_t ab = 0;
  for (int i = 0; i < rows; ++i) {
    const int row = first_of(dy) + i;
    const std::uint8_t* const p = before.cells + row * kColumns + first_of(dx);
    const std::uint8_t* const q = present.cells + (row + dy) * kColumns + first_of(dx) + dx;
    for (int k = 0; k < columns; ++k) {
      const std::int32_t u = q[k];
      const std::int32_t v = p[k];
      a += u;
      b += v;
      aa += u * u;
      bb += v * v;
      ab += u * v;
    }
  }
  const std::int64_t n = columns * rows;
  const auto covariance = static_cast<float>(n * ab - std::int64_t{a} * b);
  if (!(covariance > 0.0F)) return 0.0F;
  const auto spread_a = static_cast<float>(n * aa - std::int64_t{a} * a);
  const auto spread_b = static_cast<float>(n * bb - std::int64_t{b} * b);
  const float squared = covariance * covariance;
  const float rest = spread_a * spread_b - squared;
  constexpr float kLeastRest = 1e-3F;  // the same picture is no more than that alike
  const float least = kLeastRest * squared;
  return static_cast<float>(n) * squared / (rest > least ? rest : least);
}

void try_shift(const SmallPicture& present, const SmallPicture& before, int dx, int dy,
               PictureShift& best) {
  const int columns = kColumns - (dx < 0 ? -dx : dx);
  const int rows = kRows - (dy < 0 ? -dy : dy);
  if (columns <= 0 || rows <= 0 || columns * rows < kLeastCells) return;
  const float score = score_at(present, before, dx, dy);
  if (score > best.score) best = {dx, dy, score};
}

}  // namespace

bool SmallPicture::take(const ImageView& image) {
  const int width = image.width / kColumns;
  const int height = image.height / kRows;
  if (width < 1 || height < 1) return false;
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      cells[row * kColumns + column] = mean_of(image, column * width, row * height, width, height);
    }
  }
  return true;
}

PictureShift best_shift(const SmallPicture& present, const SmallPicture& before) {
  constexpr int kMostX = 12;
  constexpr int kMostY = 8;
  PictureShift best;
  for (int dy = -kMostY; dy <= kMostY; dy += 2) {
    for (int dx = -kMostX; dx <= kMostX; dx += 2) try_shift(present, before, dx, dy, best);
  }
  const int x = best.dx;
  const int y = best.dy;
  for (int dy = y - 1; dy <= y + 1; ++dy) {
    for (int dx = x - 1; dx <= x + 1; ++dx) {
      if (dx != x || dy != y) try_shift(present, before, dx, dy, best);
    }
  }
  return best;
}

}  // namespace cairn
