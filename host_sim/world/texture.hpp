#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

namespace cairn::host {

/// Grey texture with its mip levels. Lookup is trilinear, so that a corner keeps its place and look
/// when its distance changes.
class MipTexture {
 public:
  /// `image`: 8 bit, one channel; its sides are rounded up to a multiple of 2^(levels-1).
  explicit MipTexture(const cv::Mat& image);

  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }

  /// Weights of one lookup level pair, the same for a run of neighbouring pixels.
  struct Lod {
    int level = 0;
    int blend = 0;  ///< weight of level + 1, 0..256
  };
  /// `squared_texels`: squared size of a pixel's footprint, texels of level 0.
  Lod lod(float squared_texels) const;

  /// Intensity * 16 at (s, t) in [0, 1]^2 (clamped), t down the image.
  int sample(float s, float t, Lod lod) const {
    const int fine = bilinear(levels_[lod.level], s, t);
    if (lod.blend == 0) return fine;
    const int coarse = bilinear(levels_[lod.level + 1], s, t);
    return fine + (((coarse - fine) * lod.blend) >> 8);
  }

 private:
  struct Level {
    int width = 0;
    int height = 0;
    int stride = 0;
    std::vector<std::uint8_t> texels;  ///< one column and row more, copies of the last
  };

  static int bilinear(const Level& level, float s, float t) {
    const float x = s * static_cast<float>(level.width) - 0.5F;
    const float y = t * static_cast<float>(level.height) - 0.5F;
    int xi = static_cast<int>(x * 256.0F);
    int yi = static_cast<int>(y * 256.0F);
    const int x_max = (level.width - 1) << 8;
    const int y_max = (level.height - 1) << 8;
    xi = xi < 0 ? 0 : (xi > x_max ? x_max : xi);
    yi = yi < 0 ? 0 : (yi > y_max ? y_max : yi);
    const std::uint8_t* p = level.texels.data() + (yi >> 8) * level.stride + (xi >> 8);
    const std::uint8_t* q = p + level.stride;
    const int fx = xi & 255;
    const int fy = yi & 255;
    const int top = p[0] * (256 - fx) + p[1] * fx;
    const int bottom = q[0] * (256 - fx) + q[1] * fx;
    return (top * (256 - fy) + bottom * fy + 2048) >> 12;
  }

  std::vector<Level> levels_;
};

}  // namespace cairn::host
