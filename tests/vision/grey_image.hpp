#pragma once

#include <cstdint>
#include <vector>

#include "cairn/vision/image.hpp"

namespace cairn::test {

struct GreyImage {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> pixels;

  ImageView view() const { return {pixels.data(), width, height, width}; }
  Rect whole() const { return {0, 0, width, height}; }
};

}  // namespace cairn::test
