#pragma once

#include "cairn/base/fixed_vector.hpp"

namespace cairn {

/// The middle value, the upper one of two. Sorts `values`. Domain: not empty. Cost: n^2 / 4
/// comparisons and moves.
template <class T, int Capacity>
T sort_for_median(FixedVector<T, Capacity>& values) {
  for (int i = 1; i < values.size(); ++i) {
    const T value = values[i];
    int k = i;
    for (; k > 0 && values[k - 1] > value; --k) values[k] = values[k - 1];
    values[k] = value;
  }
  return values[values.size() / 2];
}

}  // namespace cairn
