#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

namespace detail {

/// Score rows have room for a zero on both sides and are whole groups of 32 columns.
inline constexpr int kScorePadding = 4;
constexpr int score_row_bytes(int width) {
  return (width + 31) / 32 * 32 + 2 * kScorePadding;
}

/// FastScratch without its size.
struct FastBuffers {
  std::uint8_t* scores;
  std::uint32_t* bits;
  int score_pitch;
  int bit_pitch;
  int max_width;
};

}  // namespace detail

/// Three rows of scores and corner flags for one detection, owned by the caller; one may serve any
/// number of detectors in turn, and needs no initialisation. MaxWidth: widest rectangle that can be
/// searched, in pixels. 2.2 KB for 640 columns.
template <int MaxWidth>
struct FastScratch {
  static_assert(MaxWidth > 0 && MaxWidth <= ImageView::kMaxExtent, "width out of range");
  static constexpr int kMaxWidth = MaxWidth;
  static constexpr int kScorePitch = detail::score_row_bytes(MaxWidth);
  static constexpr int kBitPitch = (MaxWidth + 31) / 32;

  alignas(4) std::uint8_t scores[3 * kScorePitch];
  std::uint32_t bits[3 * kBitPitch];

  detail::FastBuffers buffers() { return {scores, bits, kScorePitch, kBitPitch, MaxWidth}; }
};

struct FastReport {
  int candidates = 0;  ///< pixels that pass the corner test, before non-maximum suppression
  int found = 0;       ///< corners after non-maximum suppression
  int dropped = 0;     ///< of these, not returned because the output (or their cell) was full
};

/// Division of a rectangle inside the image into cells, row by row from its upper left corner; the
/// last row and column of cells may be cut. Each cell has room for `capacity` corners.
struct FastCells {
  int width = 1;
  int height = 1;
  int capacity = 0;

  int columns(const Rect& rect) const {
    return rect.empty() ? 0 : (rect.width() + width - 1) / width;
  }
  int rows(const Rect& rect) const {
    return rect.empty() ? 0 : (rect.height() + height - 1) / height;
  }
};

namespace detail {

Status detect_fast(const ImageView& image, const Rect& rect, int threshold, const FastCells& cells,
                   const FastBuffers& buffers, Corner* corners, int* counts, FastReport& report);

}  // namespace detail

/// FAST-9/16 corners (Rosten and Drummond 2006) of `image` inside `rect`, with OpenCV's score and
/// 3x3 non-maximum suppression: positions and scores equal cv::FAST(image, threshold, true,
/// TYPE_9_16) for the whole image. A corner's circle (radius 3) may reach beyond `rect` but not
/// beyond the image, so images below 7x7 have none; suppression sees only corners inside `rect`.
///
/// Writes found - dropped corners in raster order. When there are more than `capacity`, those of
/// lowest score are left out (of equal scores those later in raster order) and counted.
///
/// Domain: threshold 1..254; rect anywhere, its part inside the image within MaxWidth. Errors
/// (nothing written): kInvalidArgument, also for an invalid view. Cost: bounded by the area of
/// rect; a corner beyond the capacity costs at most log2(capacity) exchanges.
template <int MaxWidth>
Status detect_fast(const ImageView& image, const Rect& rect, int threshold,
                   FastScratch<MaxWidth>& scratch, Corner* corners, int capacity,
                   FastReport& report) {
  int count = 0;
  const FastCells whole{ImageView::kMaxExtent, ImageView::kMaxExtent, capacity};
  return detail::detect_fast(image, rect, threshold, whole, scratch.buffers(), corners, &count,
                             report);
}

/// Same, but keeps the best corners of each cell, so that one textured part of the image does not
/// take all places. Cells divide the part of `rect` inside the image. Cell c (row by row) owns
/// corners[c * cells.capacity] onwards, in raster order; counts[c] says how many. `corners` has
/// room for columns * rows * capacity, `counts` for columns * rows values. Suppression sees across
/// the borders of cells.
///
/// Domain as above; cells.width, cells.height >= 1; cells.capacity >= 0.
template <int MaxWidth>
Status detect_fast_cells(const ImageView& image, const Rect& rect, int threshold,
                         const FastCells& cells, FastScratch<MaxWidth>& scratch, Corner* corners,
                         int* counts, FastReport& report) {
  return detail::detect_fast(image, rect, threshold, cells, scratch.buffers(), corners, counts,
                             report);
}

}  // namespace cairn
