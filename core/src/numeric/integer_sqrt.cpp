#include "cairn/numeric/math.hpp"

namespace cairn {

std::uint32_t integer_sqrt(std::uint64_t value) {
  if (value == 0) return 0;
  std::uint32_t root = 0;
  const int highest = (63 - __builtin_clzll(value)) / 2;
  for (std::uint32_t bit = std::uint32_t{1} << highest; bit != 0; bit >>= 1) {
    const std::uint32_t trial = root | bit;
    if (static_cast<std::uint64_t>(trial) * trial <= value) root = trial;
  }
  return root;
}

}  // namespace cairn
