#include "host_sim/world/texture.hpp"

#include <cstring>

#include "cairn/numeric/math.hpp"

namespace cairn::host {
namespace {

constexpr int kLevels = 7;
constexpr int kMultiple = 1 << (kLevels - 1);

int rounded_up(int extent) {
  return (extent + kMultiple - 1) / kMultiple * kMultiple;
}

}  // namespace

MipTexture::MipTexture(const cv::Mat& image) {
  CV_Assert(image.type() == CV_8UC1 && !image.empty());
  const int width = rounded_up(image.cols);
  const int height = rounded_up(image.rows);
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      // Nearest: stretches a side that is no multiple by less than one level-6 texel.
      pixels[static_cast<std::size_t>(y) * width + x] =
          image.at<std::uint8_t>(y * image.rows / height, x * image.cols / width);
    }
  }
  for (int level = 0; level < kLevels; ++level) {
    const int w = width >> level;
    const int h = height >> level;
    Level stored;
    stored.width = w;
    stored.height = h;
    stored.stride = w + 1;
    stored.texels.resize(static_cast<std::size_t>(w + 1) * (h + 1));
    for (int y = 0; y <= h; ++y) {
      const std::uint8_t* source = &pixels[static_cast<std::size_t>(y < h ? y : h - 1) * w];
      std::uint8_t* row = &stored.texels[static_cast<std::size_t>(y) * stored.stride];
      std::memcpy(row, source, static_cast<std::size_t>(w));
      row[w] = source[w - 1];
    }
    levels_.push_back(std::move(stored));
    std::vector<std::uint8_t> half(static_cast<std::size_t>(w / 2) * (h / 2));
    for (int y = 0; y < h / 2; ++y) {
      for (int x = 0; x < w / 2; ++x) {
        const std::uint8_t* p = &pixels[static_cast<std::size_t>(2 * y) * w + 2 * x];
        half[static_cast<std::size_t>(y) * (w / 2) + x] =
            static_cast<std::uint8_t>((p[0] + p[1] + p[w] + p[w + 1] + 2) / 4);
      }
    }
    pixels.swap(half);
  }
}

MipTexture::Lod MipTexture::lod(float squared_texels) const {
  if (!(squared_texels > 1.0F)) return {};
  const float level = 0.72134752F * cairn::log(squared_texels);  // log2 of the size
  const float top = static_cast<float>(kLevels - 1);
  if (level >= top) return {kLevels - 1, 0};
  const int whole = static_cast<int>(level);
  return {whole, static_cast<int>((level - static_cast<float>(whole)) * 256.0F)};
}

}  // namespace cairn::host
