#pragma once

#include <cstdint>

#include "cairn/numeric/status.hpp"
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

/// Descriptor of the patch at integer pixel (x, y), self-oriented at scale index 0: equal to the
/// bit to opencv_contrib xfeatures2d::FREAK (>= 3.4.10) for a keypoint of size 7. `orientation_bin`
/// receives the orientation it found. kOutOfView when the pattern would leave the image.
Status describe_freak(const ImageView& image, int x, int y, Descriptor& descriptor,
                      std::uint8_t& orientation_bin);

/// Same at a given pose (steered): no orientation pass. kOutOfView when the pattern would leave the
/// image, kInvalidArgument when scale_index > 24.
Status describe_freak(const ImageView& image, int x, int y, FreakPose pose, Descriptor& descriptor);

/// Half-width of the square that a descriptor at this scale reads; a point nearer to the border is
/// kOutOfView.
int freak_margin(int scale_index);

}  // namespace cairn
