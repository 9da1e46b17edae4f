#pragma once

#include <cstdint>

#include "cairn/numeric/math.hpp"
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

/// Noble's score of a square of a picture, `size` pixels each side, as a whole: every second pixel
/// of every second row, but those at the picture's border. Cost: (size / 2)^2 gradients.
float texture_of(const ImageView& image, int x0, int y0, int size);

/// Candidates for features that are found again by their grey values: cells of a picture, rated by
/// their texture as a whole, but for cells near those that are known; and the best point of a cell.
/// Unlike FAST corners there always are some, in blurred pictures too.
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
  /// Closes the cells whose middle, or whose point, is within `distance` of (x, y). Domain: sums of
  /// them have an integer part that an int holds.
  void close(float x, float y, float distance);
  int open_cells() const {
    int count = 0;
    for (int i = 0; i < columns_ * rows_; ++i) count += closed_[i] ? 0 : 1;
    return count;
  }
  /// Rates the open cells: their points are their middles, until refine(). Cost: texture_of() of
  /// each.
  void rate(const ImageView& image) {
    for (int i = 0; i < columns_ * rows_; ++i) {
      if (closed_[i]) continue;
      const int x = i % columns_ * kCell;
      const int y = i / columns_ * kCell;
      points_[i].x = static_cast<std::int16_t>(x + kCell / 2);
      points_[i].y = static_cast<std::int16_t>(y + kCell / 2);
      points_[i].score = texture_of(image, x, y, kCell);
    }
  }
  /// The best point of a cell takes the place of its middle; a cell without one is closed. Cost:
  /// best_texture().
  TexturePoint refine(int cell, const ImageView& image, int margin) {
    points_[cell] =
        best_texture(image, cell % columns_ * kCell, cell / columns_ * kCell, kCell, margin);
    if (!(points_[cell].score > 0.0F)) closed_[cell] = true;
    return points_[cell];
  }
  /// Closes all cells but the best of each block of `side` x `side`, and of those all but about the
  /// `most` best. Cost: some passes over the cells.
  void keep_best(int side, int most);
  void close(int cell) { closed_[cell] = true; }
  int cells() const { return columns_ * rows_; }
  bool is_open(int cell) const { return !closed_[cell]; }
  const TexturePoint& operator[](int cell) const { return points_[cell]; }

  /// The open cell with the highest score, -1 where none has any.
  int best() const {
    int best = -1;
    float score = 0.0F;
    for (int i = 0; i < columns_ * rows_; ++i) {
      if (closed_[i] || !(points_[i].score > score)) continue;
      best = i;
      score = points_[i].score;
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
    float high = points_[best()].score;
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
  const auto cell = [](float v, int count) {
    return clamp(static_cast<int>(v) / kCell, 0, count - 1);
  };
  const int last_row = cell(y + distance, rows_);
  const int last_column = cell(x + distance, columns_);
  for (int row = cell(y - distance, rows_); row <= last_row; ++row) {
    for (int column = cell(x - distance, columns_); column <= last_column; ++column) {
      const int i = row * columns_ + column;
      if (closed_[i]) continue;
      const TexturePoint& point = points_[i];
      const bool found = point.score > 0.0F;
      const int u = found ? point.x : column * kCell + kHalf;
      const int v = found ? point.y : row * kCell + kHalf;
      const float dx = static_cast<float>(u) - x;
      const float dy = static_cast<float>(v) - y;
      closed_[i] = dx * dx + dy * dy < distance * distance;
    }
  }
}

}  // namespace cairn
