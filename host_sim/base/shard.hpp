#pragma once

#include <cstddef>

namespace cairn::host {

/// A part of an experiment. Its pieces (runs, windows, trials, faults) do not depend on each other
/// and are numbered from 0; shard `index` of `count` does every `count`th of them.
struct Shard {
  int index = 1;  ///< from 1 to count
  int count = 1;

  bool whole() const { return count == 1; }
  bool has(std::size_t piece) const {
    return piece % static_cast<std::size_t>(count) == static_cast<std::size_t>(index - 1);
  }
};

}  // namespace cairn::host
