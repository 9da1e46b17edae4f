#pragma once

#include <cstdint>

namespace cairn {

/// PCG-XSH-RR 64/32 (O'Neill 2014): small, seeded, the same sequence on every target. The state is
/// a value of the filter or tracker that uses it; there is no global generator.
class Random {
 public:
  explicit Random(std::uint64_t seed = 1) : state_(0) {
    next();
    state_ += seed;
    next();
  }

  std::uint32_t next() {
    const std::uint64_t old = state_;
    state_ = old * 6364136223846793005ULL + 1442695040888963407ULL;
    const auto shifted = static_cast<std::uint32_t>(((old >> 18U) ^ old) >> 27U);
    const auto rotation = static_cast<std::uint32_t>(old >> 59U);
    return (shifted >> rotation) | (shifted << ((32U - rotation) & 31U));
  }

  /// Uniform integer in [0, bound), bound in [1, 2^31). One multiplication, no loop: the bias is
  /// below bound / 2^32.
  int below(int bound) {
    return static_cast<int>(
        (static_cast<std::uint64_t>(next()) * static_cast<std::uint64_t>(bound)) >> 32U);
  }

 private:
  std::uint64_t state_;
};

}  // namespace cairn
