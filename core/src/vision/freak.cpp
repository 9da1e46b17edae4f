#include "cairn/vision/freak.hpp"

#include <cstring>

#include "freak_kernel.hpp"

namespace cairn {
namespace vision {
namespace {

/// Rounds a position to what a float can hold: from 64 px on its last bit is above 2^-18.
__attribute__((noinline)) std::int32_t round_as_float(std::int32_t v) {
  const int shift = 8 - __builtin_clz(static_cast<std::uint32_t>(v));
  if (shift <= 0) return v;
  const std::int32_t half = (1 << (shift - 1)) - 1 + ((v >> shift) & 1);
  return ((v + half) >> shift) << shift;
}

}  // namespace

Interval special_interval(int coordinate, std::int32_t offset, std::int32_t reach, int ring) {
  std::int32_t position = coordinate * kOnePixel + offset;
  std::int32_t begin = position - reach;
  std::int32_t end = position + reach + kOnePixel;
  if (coordinate >= kFarCoordinate) {
    position = round_as_float(position);
    begin = round_as_float(position - reach);
    end = round_as_float(round_as_float(position + reach) + kOnePixel);
  } else if (ring == 4 && is_special_coordinate(coordinate) &&
             (begin & (kOnePixel - 1)) == kOnePixel / 2) {
    begin = (begin | kOnePixel) & -kOnePixel;  // to the odd neighbour
  }
  return {round_biased(begin + kRoundingBias), round_biased(end + kRoundingBias)};
}

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
  const std::uint8_t* const value = means.value;
  for (int group = 0; group < Descriptor::kBytes / 4; ++group) {
    const std::uint8_t(*const pair)[2] = kComparisonPairs + 32 * group;
    std::uint32_t bits = 0;
    for (int b = 31; b >= 0; b -= 16) {
      append_comparison(bits, value[pair[b][0]], value[pair[b][1]]);
      append_comparison(bits, value[pair[b - 1][0]], value[pair[b - 1][1]]);
      append_comparison(bits, value[pair[b - 2][0]], value[pair[b - 2][1]]);
      append_comparison(bits, value[pair[b - 3][0]], value[pair[b - 3][1]]);
      append_comparison(bits, value[pair[b - 4][0]], value[pair[b - 4][1]]);
      append_comparison(bits, value[pair[b - 5][0]], value[pair[b - 5][1]]);
      append_comparison(bits, value[pair[b - 6][0]], value[pair[b - 6][1]]);
      append_comparison(bits, value[pair[b - 7][0]], value[pair[b - 7][1]]);
      append_comparison(bits, value[pair[b - 8][0]], value[pair[b - 8][1]]);
      append_comparison(bits, value[pair[b - 9][0]], value[pair[b - 9][1]]);
      append_comparison(bits, value[pair[b - 10][0]], value[pair[b - 10][1]]);
      append_comparison(bits, value[pair[b - 11][0]], value[pair[b - 11][1]]);
      append_comparison(bits, value[pair[b - 12][0]], value[pair[b - 12][1]]);
      append_comparison(bits, value[pair[b - 13][0]], value[pair[b - 13][1]]);
      append_comparison(bits, value[pair[b - 14][0]], value[pair[b - 14][1]]);
      append_comparison(bits, value[pair[b - 15][0]], value[pair[b - 15][1]]);
    }
    std::memcpy(descriptor.bytes + 4 * group, &bits, sizeof bits);
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
  const vision::RingSize outer = vision::ring_size(0, index);
  const std::int32_t reach = outer.radius + outer.reach;
  return ((reach + vision::kOnePixel - 1) >> vision::kPositionBits) + 2;
}

}  // namespace cairn
