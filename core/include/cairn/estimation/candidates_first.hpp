#pragma once

namespace cairn::detail {

/// Moves the items that are flagged to the front, in their order; the number of them.
template <class Item>
int flagged_first(Item* items, const bool* flags, int count) {
  int first = 0;
  for (int k = 0; k < count; ++k) {
    if (!flags[k]) continue;
    const Item moved = items[k];
    items[k] = items[first];
    items[first++] = moved;
  }
  return first;
}

/// Asks `good` of every item, and moves those for which it is false to the end; the number of the
/// others.
template <class Item, class Good>
int good_first(Item* items, int count, const Good& good) {
  int k = 0;
  while (k < count) {
    if (good(items[k])) {
      ++k;
      continue;
    }
    const Item moved = items[k];
    items[k] = items[--count];
    items[count] = moved;
  }
  return count;
}

}  // namespace cairn::detail
