#pragma once

#include <cstring>

#include "cairn/base/health.hpp"
#include "cairn/c_api/types.h"

namespace cairn::c_api {

/// Counters in the same order, checked one by one in health.cpp.
inline void copy_health(const Health& health, cairn_health& out) {
  static_assert(sizeof(Health) == sizeof(cairn_health), "counters of cairn_health");
  std::memcpy(&out, &health, sizeof out);
}

}  // namespace cairn::c_api
