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
  /// Closes all cells but the best of each block of `side` x `side`, and of those all but about the
  /// `most` best. Cost: some passes over the cells.
  void keep_best(int side, int most);
  int cells() const { return columns_ * rows_; }
  bool is_open(int cell) const { return !closed_[cell]; }
  const TexturePoint& operator[](int cell) const { return points_[cell]; }

  /// The best point of the open cells, one with score 0 where there is none.
  TexturePoint best() const {
    TexturePoint best;
    for (int i = 0; i < columns_ * rows_; ++i) {
      if (!closed_[i] && points_[i].score > best.score) best = points_[i];
    }
    return best;
  }

 private:
  int better_than(float score) const {
    int count = 0;
    for (int i = 0; i < cells(); ++i) count += !closed_[i] && points_[i].score > score ? 1 : 0;
    return count;
  }
  void keep_best_of_block(int column, int row, int side);

  TexturePoint points_[kMaxCells];
  bool closed_[kMaxCells];
  int columns_ = 0;
  int rows_ = 0;
};

template <int MaxWidth, int MaxHeight>
void TexturePoints<MaxWidth, MaxHeight>::keep_best_of_block(int column, int row, int side) {
  int best = -1;
  for (int y = row; y < row + side && y < rows_; ++y) {
    for (int x = column; x < column + side && x < columns_; ++x) {
      const int i = y * columns_ + x;
      if (closed_[i]) continue;
      closed_[i] = true;
      if (points_[i].score > 0.0F && (best < 0 || points_[i].score > points_[best].score)) best = i;
    }
  }
  if (best >= 0) closed_[best] = false;
}

template <int MaxWidth, int MaxHeight>
void TexturePoints<MaxWidth, MaxHeight>::keep_best(int side, int most) {
  constexpr int kHalvings = 24;
  for (int row = 0; row < rows_; row += side) {
    for (int column = 0; column < columns_; column += side) keep_best_of_block(column, row, side);
  }
  float low = 0.0F;
  if (better_than(low) > most) {
    // The score that `most` points exceed lies between low and high.
    float high = best().score;
    for (int i = 0; i < kHalvings; ++i) {
      const float middle = 0.5F * (low + high);
      (better_than(middle) > most ? low : high) = middle;
    }
    low = high;
  }
  for (int i = 0; i < cells(); ++i) {
    if (!(points_[i].score > low)) closed_[i] = true;
  }
}

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
