#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

/// A picture at a quarter of its size: means of 4x4 pixels. Its pixel x is the picture's pixel
/// 4 x + 1.5. `MaxWidth`, `MaxHeight`: of the picture.
template <int MaxWidth, int MaxHeight>
class QuarterImage {
 public:
  /// Domain: a valid image of at most that size. One below 4x4 gives no view.
  void take(const ImageView& image);
  ImageView view() const { return {pixels_, width_, height_, width_}; }

 private:
  std::uint8_t pixels_[(MaxWidth / 4) * (MaxHeight / 4)];
  int width_ = 0;
  int height_ = 0;
};

/// 11x11 grey values around a point.
struct SmallTemplate {
  static constexpr int kSide = 11;
  static constexpr int kHalf = kSide / 2;
  std::uint8_t pixels[kSide * kSide] = {};
};

struct TemplateMatch {
  std::int32_t x_q8 = 0;  ///< of the template's centre, 1/256 pixel
  std::int32_t y_q8 = 0;
  std::int32_t correlation = 0;  ///< zero-mean normalised, Q15, at the best whole pixel
};

namespace detail {
void quarter_row(const ImageView& image, int row, std::uint8_t* out);
}

/// Copies the pixels around (x, y). False, `out` unchanged, where some are outside the image.
bool take_template(const ImageView& image, int x, int y, SmallTemplate& out);

/// Where the image within `radius` of (x, y) in both axes looks most like the template, by
/// zero-mean normalised correlation: best whole pixel, then a parabola through its neighbours in
/// either axis. Integers only. kNotFound, `match` untouched: nothing correlates by at least
/// `least_q15`, the best place is at the window's border (which may be the image's) or the template
/// has no texture. Domain: valid image, 1 <= radius <= kMaxSearchRadius. Cost: (2 radius + 1)^2
/// products of 121 pixels, and a sum and a square of each pixel in the window.
inline constexpr int kMaxSearchRadius = 16;
Status find_template(const ImageView& image, const SmallTemplate& reference, int x, int y,
                     int radius, int least_q15, TemplateMatch& match);

template <int MaxWidth, int MaxHeight>
void QuarterImage<MaxWidth, MaxHeight>::take(const ImageView& image) {
  width_ = image.width / 4;
  height_ = image.height / 4;
  for (int row = 0; row < height_; ++row) {
    detail::quarter_row(image, row, pixels_ + static_cast<std::ptrdiff_t>(row) * width_);
  }
}

}  // namespace cairn
