#pragma once

#include <cstdint>

#include "cairn/vision/image.hpp"

namespace cairn {

/// An image as a whole: the means of 20 x 15 cells.
struct SmallPicture {
  static constexpr int kColumns = 20;
  static constexpr int kRows = 15;
  std::uint8_t cells[kRows * kColumns] = {};

  /// Cells that do not fill the image leave out its last columns and rows. False, unchanged, for an
  /// image with less than a pixel a cell. Cost: a sum over the image.
  bool take(const ImageView& image);
};

/// How a picture is moved against an earlier one, in whole cells: what was at cell x then is at
/// x + dx now.
struct PictureShift {
  int dx = 0;
  int dy = 0;
  /// r^2 n / (1 - r^2) of the correlation r over n common cells: the less likely by chance, the
  /// larger. 0 where no shift correlates.
  float score = 0.0F;
};

/// The shift with the highest score of those that leave 40 % of the cells in common, up to 12
/// columns and 8 rows: every second one, then the neighbours of the best. Cost: 73 comparisons of
/// some 175 cells, and 8 of at most 300.
PictureShift best_shift(const SmallPicture& present, const SmallPicture& before);

}  // namespace cairn
