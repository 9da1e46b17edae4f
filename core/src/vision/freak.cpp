#include "cairn/vision/freak.hpp"

#include "freak_kernel.hpp"

namespace cairn {
namespace vision {

int orientation_bin_of(int dx, int dy) {
  const auto x = static_cast<std::uint32_t>(dx < 0 ? -dx : dx);
  const auto y = static_cast<std::uint32_t>(dy < 0 ? -dy : dy);
  const std::uint32_t low = x < y ? x : y;
  const std::uint32_t high = x < y ? y : x;
  if (high == 0) return 0;
  // Bin within the first eighth of a turn: the number of bin borders below the angle.
  int bin = 0;
  for (int step = 16; step > 0; step /= 2) {
    const auto border = static_cast<std::uint64_t>(kBinTangent[bin + step - 1]) * high;
    if (static_cast<std::uint64_t>(low) << 28U > border) bin += step;
  }
  if (static_cast<std::uint64_t>(low) << 28U >
      static_cast<std::uint64_t>(kBinTangent[bin]) * high) {
    ++bin;
  }
  if (x < y) bin = 64 - bin;
  if (dx < 0) bin = 128 - bin;
  if (dy < 0) bin = 256 - bin;
  return bin & 255;
}

int freak_orientation(const FreakMeans& means, FreakOrientation precision) {
  const bool opencv = precision == FreakOrientation::kOpenCv;
  int dx = 0;
  int dy = 0;
  for (const OrientationPair& pair : kOrientationPairs) {
    const int difference = means.value[pair.first] - means.value[pair.second];
    const int x = difference * pair.weight_x;
    const int y = difference * pair.weight_y;
    // OpenCV cuts each term to an integer, towards zero.
    dx += opencv ? x / 2048 : x;
    dy += opencv ? y / 2048 : y;
  }
  return orientation_bin_of(dx, dy);
}

void compare_means(const FreakMeans& means, Descriptor& descriptor) {
  const std::uint8_t(*pair)[2] = kComparisonPairs;
  for (int byte = 0; byte < Descriptor::kBytes; ++byte, pair += 8) {
    unsigned bits = 0;
    for (int b = 7; b >= 0; --b) {
      bits = 2 * bits + (means.value[pair[b][0]] >= means.value[pair[b][1]] ? 1U : 0U);
    }
    descriptor.bytes[byte] = static_cast<std::uint8_t>(bits);
  }
}

}  // namespace vision

Status describe_freak(const ImageView& image, int x, int y, Descriptor& descriptor,
                      std::uint8_t& orientation_bin, FreakOrientation precision) {
  return vision::describe_freak_with<vision::NativeLanes>(image, x, y, precision, descriptor,
                                                          orientation_bin);
}

Status describe_freak(const ImageView& image, int x, int y, FreakPose pose,
                      Descriptor& descriptor) {
  return vision::describe_freak_with<vision::NativeLanes>(image, x, y, pose, descriptor);
}

int freak_margin(int scale_index) {
  const int index = scale_index < 0                        ? 0
                    : scale_index > vision::kMaxScaleIndex ? vision::kMaxScaleIndex
                                                           : scale_index;
  const std::int32_t reach =
      vision::scaled_radius(0, index, 0) + vision::scaled_radius(0, index, 1);
  return ((reach + vision::kOnePixel - 1) >> vision::kPositionBits) + 2;
}

}  // namespace cairn
