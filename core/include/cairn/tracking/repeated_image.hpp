#pragma once

#include <cstdint>
#include <cstring>

#include "cairn/vision/image.hpp"

namespace cairn {

namespace work {

/// RepeatedImage::take(), in units.
inline constexpr int repeated_image(int width, int height) {
  constexpr int kRowStep = 16;
  constexpr int kBytesPerUnit = 300;
  return 1 + (height + kRowStep - 1) / kRowStep * width / kBytesPerUnit;
}

}  // namespace work

/// Tells a picture that a hanging camera or driver hands out again. No camera with read-out noise
/// gives the same bytes twice, unless it is dark, covered or saturated: pictures of one grey level
/// do not count.
class RepeatedImage {
 public:
  static constexpr int kRowStep = 16;  ///< rows from one that is compared to the next

  void reset() { *this = RepeatedImage(); }

  /// Whether `image` has the bytes of the one taken before, by a 64-bit hash over every 16th row.
  /// Domain: valid image. Cost: work::repeated_image().
  bool take(const ImageView& image) {
    std::uint64_t hash = 14695981039346656037ULL;
    bool flat = true;
    for (int row = 0; row < image.height; row += kRowStep) {
      const std::uint8_t* p = image.data + static_cast<std::int64_t>(row) * image.stride;
      flat = add_row(p, image.width, image.data[0], hash) && flat;
    }
    const bool repeated = has_hash_ && !flat && hash == hash_;
    hash_ = hash;
    has_hash_ = true;
    return repeated;
  }

 private:
  /// FNV-1a, four bytes at a time; returns whether all of them are `grey`.
  static bool add_row(const std::uint8_t* p, int width, std::uint8_t grey, std::uint64_t& hash) {
    constexpr std::uint64_t kPrime = 1099511628211ULL;
    const std::uint32_t all_grey = grey * 0x01010101U;
    bool flat = true;
    int i = 0;
    for (; i + 4 <= width; i += 4) {
      std::uint32_t word = 0;
      std::memcpy(&word, p + i, sizeof word);
      flat = flat && word == all_grey;
      hash = (hash ^ word) * kPrime;
    }
    for (; i < width; ++i) {
      flat = flat && p[i] == grey;
      hash = (hash ^ p[i]) * kPrime;
    }
    return flat;
  }

  std::uint64_t hash_ = 0;
  bool has_hash_ = false;
};

}  // namespace cairn
