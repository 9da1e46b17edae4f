#include "host_sim/commands/progress.hpp"

#include <cstdio>
#include <unistd.h>

#include <fmt/format.h>

namespace cairn::host {

void show_progress(const char* what, int done, int total) {
  if (isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\r{} {} of {}", what, done, total);
  if (done == total) fmt::print(stderr, "\r{:40}\r", "");
  std::fflush(stderr);
}

}  // namespace cairn::host
