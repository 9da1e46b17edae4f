#pragma once

#include <string>

namespace cairn::host {

/// How this program was built and what it runs on: what a latency figure depends on.
struct BuildInfo {
  std::string version;
  std::string compiler;
  std::string flags;
  std::string cpu;
};

BuildInfo build_info();

}  // namespace cairn::host
