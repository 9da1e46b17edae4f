#pragma once

#include <cstdint>

#include "cairn/base/status.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

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

}  // namespace cairn
