#pragma once

#include <cstdint>

namespace cairn_test {

/// FNV-1a, 64 bits.
class Sum {
 public:
  void add(const void* data, int bytes) {
    const auto* p = static_cast<const std::uint8_t*>(data);
    for (int i = 0; i < bytes; ++i) value_ = (value_ ^ p[i]) * 0x100000001B3U;
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xCBF29CE484222325U;
};

/// Descriptors at every coordinate: noise of Random(kNoiseSeed), once as an image of 4,096 x 64
/// pixels and once, the same bytes, as 64 x 4,096. For k from 24 to 4,072, self-oriented and then
/// upright: that at (k, across(k)) of the first image and that at (across(k), k) of the second.
/// freak_oracle_test (tests/benchmark) finds the same sum over OpenCV's descriptors.
inline constexpr std::uint64_t kNoiseSeed = 23;
inline constexpr int kLong = 4096;
inline constexpr int kShort = 64;
inline constexpr int kMargin = 24;
inline constexpr std::uint64_t kFreakSumOfAllCoordinates = 0xACDD4EB7810C8B9D;
constexpr int across(int k) {
  return kMargin + k % 17;
}

}  // namespace cairn_test
