#pragma once

#include <chrono>
#include <cstdint>

#include "cairn/base/ticks.hpp"

namespace cairn::host {

inline constexpr double kHostTicksPerMs = 1e6;

/// Monotonic clock in nanoseconds, wrapping every 4.3 s as a board's counter does.
inline TickSource host_ticks() {
  return {[](void*) {
            const auto now = std::chrono::steady_clock::now().time_since_epoch();
            return static_cast<std::uint32_t>(
                std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
          },
          nullptr};
}

}  // namespace cairn::host
