#pragma once

#include <chrono>
#include <cstdint>
#include <ctime>

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

/// The processor's own clock of this thread, ms: it stands still while other programs have the
/// core.
inline double core_clock_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

}  // namespace cairn::host
