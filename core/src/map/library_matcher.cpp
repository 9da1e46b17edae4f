#include "cairn/map/library_matcher.hpp"

#include <cstddef>
#include <cstring>

namespace cairn {

int hamming_prefix_distance(const Descriptor& a, const Descriptor& b) {
  std::uint32_t sum = 0;
  for (std::size_t word = 0; word < 4; ++word) {
    std::uint32_t x = 0;
    std::uint32_t y = 0;
    std::memcpy(&x, a.bytes + 4 * word, sizeof x);
    std::memcpy(&y, b.bytes + 4 * word, sizeof y);
    std::uint32_t v = x ^ y;
    v = v - ((v >> 1U) & 0x55555555U);
    v = (v & 0x33333333U) + ((v >> 2U) & 0x33333333U);
    sum += (v + (v >> 4U)) & 0x0F0F0F0FU;
  }
  return static_cast<int>((sum * 0x01010101U) >> 24U);
}

}  // namespace cairn
