#pragma once

#include <cstddef>
#include <cstdint>

#include "cairn/vision/image.hpp"

namespace cairn {

inline constexpr int kSmallPicture = 320 * 240;  ///< pixels

/// How many pixels of a picture, each way, make one of its ShrunkImage: so that the shrunk image is
/// some 160 pixels wide, and a template in it covers the same part of the view, whatever the
/// picture's size.
inline constexpr int shrink_factor(int width, int height) {
  constexpr int kLarge = 2 * 640 * 480;
  return width * height <= kSmallPicture ? 2 : width * height <= kLarge ? 4 : 8;
}

/// A picture shrunk by shrink_factor() f: means of f x f pixels. Its pixel x is the picture's pixel
/// f x + (f - 1) / 2. `MaxWidth`, `MaxHeight`: of the picture.
template <int MaxWidth, int MaxHeight>
class ShrunkImage {
 public:
  /// Domain: a valid image of at most that size. One below f x f gives no view.
  void take(const ImageView& image);
  ImageView view() const { return {pixels_, width_, height_, width_}; }
  /// Of the picture taken last.
  int factor() const { return factor_; }
  float to_shrunk(float v) const { return (v - centre()) / static_cast<float>(factor_); }
  float to_picture(float v) const { return static_cast<float>(factor_) * v + centre(); }

 private:
  static constexpr int kMaxPixels = MaxWidth * MaxHeight;
  static constexpr int kHalved = (kMaxPixels < kSmallPicture ? kMaxPixels : kSmallPicture) / 4;
  float centre() const { return 0.5F * static_cast<float>(factor_ - 1); }

  std::uint8_t pixels_[kHalved > kMaxPixels / 16 ? kHalved : kMaxPixels / 16];
  int width_ = 0;
  int height_ = 0;
  int factor_ = 4;
};

namespace detail {
void shrink_row(const ImageView& image, int factor, int row, std::uint8_t* out);
}

template <int MaxWidth, int MaxHeight>
void ShrunkImage<MaxWidth, MaxHeight>::take(const ImageView& image) {
  factor_ = shrink_factor(image.width, image.height);
  width_ = image.width / factor_;
  height_ = image.height / factor_;
  for (int row = 0; row < height_; ++row) {
    detail::shrink_row(image, factor_, row, pixels_ + static_cast<std::ptrdiff_t>(row) * width_);
  }
}

}  // namespace cairn
