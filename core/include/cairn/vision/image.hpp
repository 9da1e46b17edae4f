#pragma once

#include <cstddef>
#include <cstdint>

namespace cairn {

/// Read-only view of an 8-bit grey image owned by the caller. Pixel (0, 0) is the first byte; row y
/// starts at data + y * stride. Valid when data is set, 1 <= width <= stride and 1 <= height <=
/// 4096.
struct ImageView {
  const std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  int stride = 0;

  static constexpr int kMaxExtent = 4096;

  bool valid() const {
    return data != nullptr && width > 0 && height > 0 && width <= kMaxExtent &&
           height <= kMaxExtent && stride >= width;
  }
  const std::uint8_t* row(int y) const { return data + static_cast<std::ptrdiff_t>(y) * stride; }
};

/// Same, writable: the target of drawing.
struct MutableImageView {
  std::uint8_t* data = nullptr;
  int width = 0;
  int height = 0;
  int stride = 0;

  std::uint8_t* row(int y) const { return data + static_cast<std::ptrdiff_t>(y) * stride; }
  operator ImageView() const { return {data, width, height, stride}; }  // NOLINT: view conversion
};

/// Half-open rectangle of pixels: x in [x0, x1), y in [y0, y1).
struct Rect {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  bool empty() const { return x1 <= x0 || y1 <= y0; }
};

constexpr Rect intersect(const Rect& a, const Rect& b) {
  return {a.x0 > b.x0 ? a.x0 : b.x0, a.y0 > b.y0 ? a.y0 : b.y0, a.x1 < b.x1 ? a.x1 : b.x1,
          a.y1 < b.y1 ? a.y1 : b.y1};
}

/// A FAST corner: pixel coordinates of its centre and its score (the largest threshold at which it
/// is still a corner, as cv::FAST reports it).
struct Corner {
  std::int16_t x = 0;
  std::int16_t y = 0;
  std::uint8_t score = 0;
};

}  // namespace cairn
