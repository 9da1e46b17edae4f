#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

/// FREAK descriptor (Alahi, Ortiz, Vandergheynst 2012): 512 comparisons, byte order as OpenCV.
struct Descriptor {
  static constexpr int kBytes = 64;
  alignas(8) std::uint8_t bytes[kBytes] = {};
};

/// How the sampling pattern is laid on the image. `orientation_bin`: multiple of 1/256 turn,
/// clockwise in the image (x right, y down) as OpenCV's theta; `scale_index`: pattern scale 22 px *
/// 2^(scale_index/16), 0..24.
struct FreakPose {
  std::uint8_t orientation_bin = 0;
  std::uint8_t scale_index = 0;
};

/// How precisely a self-oriented descriptor finds its orientation. OpenCV cuts each of the 45 terms
/// of the gradient to an integer; kFull keeps them whole: a little better, but not its results.
enum class FreakOrientation : std::uint8_t { kOpenCv, kFull };

/// Descriptor of the patch at integer pixel (x, y), self-oriented at scale index 0: equal to the
/// bit to opencv_contrib xfeatures2d::FREAK (>= 3.4.10) for a keypoint of size 7, at any coordinate
/// up to 4,096. `orientation_bin` receives the orientation it found.
///
/// Errors (outputs unchanged): kOutOfView when the pattern would leave the image, kInvalidArgument
/// for an invalid view. Cost: two passes over 43 boxes of at most 16x16 pixels, 512 comparisons; no
/// memory but about 200 bytes of stack.
Status describe_freak(const ImageView& image, int x, int y, Descriptor& descriptor,
                      std::uint8_t& orientation_bin,
                      FreakOrientation precision = FreakOrientation::kOpenCv);

/// Same at a given pose (steered; pose {} is upright): one pass, no orientation. Boxes grow with
/// the scale, to 43x43 pixels at scale index 24. kInvalidArgument also when scale_index > 24.
Status describe_freak(const ImageView& image, int x, int y, FreakPose pose, Descriptor& descriptor);

/// Distance from the border that a descriptor needs, as OpenCV demands it: the point (x, y) can be
/// described when margin <= x <= width - margin, and y alike. 24 at scale index 0, 65 at 24; scale
/// indices outside 0..24 count as the nearest one inside.
int freak_margin(int scale_index);

}  // namespace cairn
