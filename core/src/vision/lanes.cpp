#include "lanes.hpp"

namespace cairn::vision {

/// Only large scales have such boxes: short code, column by column.
std::uint32_t WordLanes::wide_box_sum(const std::uint8_t* p, std::ptrdiff_t stride, int width,
                                      int height) {
  std::uint32_t sum = 0;
  for (; width >= 16; width -= 16, p += 16) sum += detail::sum_rows<4, 0>(p, stride, height);
  if (width >= 8) {
    sum += detail::sum_rows<2, 0>(p, stride, height);
    width -= 8;
    p += 8;
  }
  if (width >= 4) {
    sum += detail::sum_rows<1, 0>(p, stride, height);
    width -= 4;
    p += 4;
  }
  if (width >= 2) {
    sum += detail::sum_rows<0, 2>(p, stride, height);
    p += 2;
  }
  return (width & 1) != 0 ? sum + detail::sum_rows<0, 1>(p, stride, height) : sum;
}

}  // namespace cairn::vision
