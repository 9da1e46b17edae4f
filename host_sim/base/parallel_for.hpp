#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace cairn::host {

/// Calls `body(i)` once for every i below `count`, on up to `threads` threads (0: as many as the
/// machine has), the caller's among them. Which thread takes which i, and when, is open: a result
/// that repeats must not depend on it. The first exception ends the loop and is thrown on.
template <class Body>
void parallel_for(std::size_t count, int threads, const Body& body) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr error;
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) body(i);
    } catch (...) {
      next = count;
      const std::lock_guard<std::mutex> lock(mutex);
      if (!error) error = std::current_exception();
    }
  };
  const auto machine = static_cast<int>(std::thread::hardware_concurrency());
  const auto wanted = static_cast<std::size_t>(std::max(1, threads > 0 ? threads : machine));
  std::vector<std::thread> others;
  for (std::size_t i = 1; i < std::min(wanted, count); ++i) others.emplace_back(work);
  work();
  for (std::thread& other : others) other.join();
  if (error) std::rethrow_exception(error);
}

}  // namespace cairn::host
