#pragma once

#include <cstdint>

#include "cairn/base/hash.hpp"

namespace cairn::host {

/// Fingerprint of a core tracker's estimate, without its counters of refused inputs.
template <class Core>
std::uint64_t hash_of_state(const Core& core) {
  Hash64 hash;
  core.hash(hash);
  return hash.value();
}

}  // namespace cairn::host
