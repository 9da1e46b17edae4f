#include "cairn/vision/shrunk_image.hpp"

#include <cstring>

namespace cairn::detail {
namespace {

/// Sums of the even and of the odd bytes of a word, in its two halves.
std::uint32_t byte_sums(const std::uint8_t* p) {
  constexpr std::uint32_t kEven = 0x00FF00FFU;
  std::uint32_t word = 0;
  std::memcpy(&word, p, sizeof word);
  return (word & kEven) + ((word >> 8U) & kEven);
}

std::uint8_t block_mean(std::uint32_t sums, std::uint32_t pixels) {
  return static_cast<std::uint8_t>(((sums & 0xFFFFU) + (sums >> 16U) + pixels / 2) / pixels);
}

/// Means of blocks of 4x4 pixels, each row of a block a word.
void quarter_row(const ImageView& image, int row, std::uint8_t* out) {
  const int width = image.width / 4;
  const std::uint8_t* p = image.row(4 * row);
  const std::ptrdiff_t stride = image.stride;
  for (int x = 0; x < width; ++x, p += 4) {
    out[x] = block_mean(byte_sums(p) + byte_sums(p + stride) + byte_sums(p + 2 * stride) +
                            byte_sums(p + 3 * stride),
                        16);
  }
}

void eighth_row(const ImageView& image, int row, std::uint8_t* out) {
  const int width = image.width / 8;
  const std::uint8_t* p = image.row(8 * row);
  for (int x = 0; x < width; ++x, p += 8) {
    std::uint32_t sums = 0;
    for (int i = 0; i < 8; ++i) {
      const std::uint8_t* const line = p + i * static_cast<std::ptrdiff_t>(image.stride);
      sums += byte_sums(line) + byte_sums(line + 4);
    }
    out[x] = block_mean(sums, 64);
  }
}

void halve_row(const ImageView& image, int row, std::uint8_t* out) {
  const int width = image.width / 2;
  const std::uint8_t* const upper = image.row(2 * row);
  const std::uint8_t* const lower = upper + image.stride;
  for (int x = 0; x < width; ++x) {
    const std::uint32_t sum = static_cast<std::uint32_t>(upper[2 * x]) + upper[2 * x + 1] +
                              lower[2 * x] + lower[2 * x + 1];
    out[x] = static_cast<std::uint8_t>((sum + 2) / 4);
  }
}

}  // namespace

void shrink_row(const ImageView& image, int factor, int row, std::uint8_t* out) {
  switch (factor) {
    case 2:
      return halve_row(image, row, out);
    case 4:
      return quarter_row(image, row, out);
    default:
      return eighth_row(image, row, out);
  }
}

}  // namespace cairn::detail
