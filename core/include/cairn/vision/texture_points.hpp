#pragma once

#include <cstdint>

#include "cairn/vision/image.hpp"

namespace cairn {

/// A point around which the picture changes in both directions.
struct TexturePoint {
  std::int16_t x = 0;
  std::int16_t y = 0;
  float score = 0.0F;  ///< 0: none
};

/// The best point of a cell whose upper left pixel is (x0, y0) and whose side is `size` (8, 16 or
/// 32): every second pixel of every second row is tried. Score: Noble's, determinant / trace of the
/// products of central differences, summed over 3x3 of those pixels; it lies between the smaller
/// eigenvalue (Shi and Tomasi 1994) and half of it. Only pixels at least `margin` (>= 3) from the
/// image's border count. Cost: (size / 2 + 2)^2 gradients.
TexturePoint best_texture(const ImageView& image, int x0, int y0, int size, int margin);

/// Candidates for features that are found again by their grey values: the best point of each cell
/// of a picture, but for cells near those that are known. Unlike FAST corners there always are
/// some, in blurred pictures too.
template <int MaxWidth, int MaxHeight>
class TexturePoints {
 public:
  static constexpr int kCell = MaxWidth > 640 ? 32 : 16;  ///< pixels, each side
  static constexpr int kMaxCells =
      ((MaxWidth + kCell - 1) / kCell) * ((MaxHeight + kCell - 1) / kCell);

  /// Starts with a picture of that size, at most MaxWidth x MaxHeight: all cells are open.
  void begin(int width, int height) {
    columns_ = (width + kCell - 1) / kCell;
    rows_ = (height + kCell - 1) / kCell;
    for (int i = 0; i < columns_ * rows_; ++i) {
      points_[i] = TexturePoint();
      closed_[i] = false;
    }
  }
  /// Closes the cells whose middle, or whose point, is within `distance` of (x, y).
  void close(float x, float y, float distance);
  int open_cells() const {
    int count = 0;
    for (int i = 0; i < columns_ * rows_; ++i) count += closed_[i] ? 0 : 1;
    return count;
  }
  /// Finds the points of the open cells. Cost: best_texture() of each.
  void find(const ImageView& image, int margin) {
    for (int i = 0; i < columns_ * rows_; ++i) {
      if (closed_[i]) continue;
      points_[i] = best_texture(image, i % columns_ * kCell, i / columns_ * kCell, kCell, margin);
    }
  }
  /// The best point of the open cells, one with score 0 where there is none.
  TexturePoint best() const {
    TexturePoint best;
    for (int i = 0; i < columns_ * rows_; ++i) {
      if (!closed_[i] && points_[i].score > best.score) best = points_[i];
    }
    return best;
  }

 private:
  TexturePoint points_[kMaxCells];
  bool closed_[kMaxCells];
  int columns_ = 0;
  int rows_ = 0;
};

template <int MaxWidth, int MaxHeight>
void TexturePoints<MaxWidth, MaxHeight>::close(float x, float y, float distance) {
  constexpr int kHalf = kCell / 2;
  for (int i = 0; i < columns_ * rows_; ++i) {
    if (closed_[i]) continue;
    const TexturePoint& point = points_[i];
    const bool found = point.score > 0.0F;
    const int u = found ? point.x : i % columns_ * kCell + kHalf;
    const int v = found ? point.y : i / columns_ * kCell + kHalf;
    const float dx = static_cast<float>(u) - x;
    const float dy = static_cast<float>(v) - y;
    closed_[i] = dx * dx + dy * dy < distance * distance;
  }
}

}  // namespace cairn
