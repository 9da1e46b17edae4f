#pragma once

#include "cairn/numeric/fixed_vector.hpp"
#include "cairn/numeric/status.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

/// Rows of scores and corner lists for one detection, owned by the caller; one may serve any number
/// of detectors in turn. MaxWidth: widest rectangle that can be searched, in pixels.
template <int MaxWidth>
struct FastScratch {
  static constexpr int kMaxWidth = MaxWidth;
  std::uint8_t score_rows[3][MaxWidth];
  std::int16_t corner_columns[3][MaxWidth];
};

struct FastReport {
  int found = 0;    ///< corners after non-maximum suppression
  int dropped = 0;  ///< of these, not returned because `capacity` was reached
};

/// FAST-9/16 corners (Rosten and Drummond 2006) of `image` inside `rect`, with OpenCV's score and
/// 3x3 non-maximum suppression: positions and scores equal cv::FAST(image, threshold, true,
/// TYPE_9_16) for the whole image. A corner's circle (radius 3) may reach beyond `rect` but not
/// beyond the image; suppression sees only corners inside `rect`. Corners come in raster order;
/// when there are more than `capacity`, those of lowest score are left out and counted.
///
/// Domain: threshold 1..254, rect within MaxWidth. kInvalidArgument otherwise or for an invalid
/// view. Cost: bounded by rect area (about 26 instructions a pixel on a textured image, Cortex-M7).
template <int MaxWidth>
Status detect_fast(const ImageView& image, const Rect& rect, int threshold,
                   FastScratch<MaxWidth>& scratch, Corner* corners, int capacity,
                   FastReport& report);

}  // namespace cairn
