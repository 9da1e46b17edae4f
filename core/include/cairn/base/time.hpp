#pragma once

#include <cstdint>
#include <limits>

namespace cairn {

/// later - earlier, clamped to the range of the type: stamps from outside may lie anywhere.
constexpr std::int64_t difference_us(std::int64_t later, std::int64_t earlier) {
  constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
  if (earlier < 0 && later > kMax + earlier) return kMax;
  if (earlier > 0 && later < kMin + earlier) return kMin;
  return later - earlier;
}

/// Extends a 32-bit microsecond counter, which wraps every 71.6 minutes, to 64 bits. Stamps may
/// come out of order by less than half of that. Plain value, no error.
class WrappingClock {
 public:
  /// The 64-bit time of `counter`, us; the first one counts from 0 upwards.
  std::int64_t extend(std::uint32_t counter) {
    if (!started_) {
      started_ = true;
      time_us_ = counter;
      return time_us_;
    }
    const std::uint32_t forward = counter - static_cast<std::uint32_t>(time_us_);
    constexpr std::uint32_t kHalf = 0x80000000U;
    if (forward >= kHalf) return time_us_ - static_cast<std::int64_t>(0U - forward);
    time_us_ += forward;
    return time_us_;
  }

 private:
  std::int64_t time_us_ = 0;  ///< newest so far
  bool started_ = false;
};

}  // namespace cairn
