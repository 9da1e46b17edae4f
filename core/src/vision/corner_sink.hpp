#pragma once

#include <cstdint>

#include "cairn/vision/fast.hpp"

namespace cairn::vision {

/// Takes corners in raster order and keeps the best of each cell within its capacity. A cell's
/// slice of the output turns into a heap with the worst corner at its root when the first corner
/// too many arrives, and is put back into raster order at the end.
class CornerSink {
 public:
  /// `rect` is not empty, or nothing is added. Clears the counts of all cells.
  CornerSink(const Rect& rect, const FastCells& cells, Corner* corners, int* counts);

  void add(int x, int y, int score);
  void finish();

  int found() const { return found_; }
  int dropped() const { return dropped_; }

 private:
  Rect rect_;
  FastCells cells_;
  int columns_;
  int cell_count_;
  Corner* corners_;
  int* counts_;
  int found_ = 0;
  int dropped_ = 0;
};

}  // namespace cairn::vision
