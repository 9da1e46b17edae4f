#pragma once

#include "cairn/tracking/active_search.hpp"

namespace cairn {

/// Memory that the steps of a frame use one after the other. Nothing in it outlives its step:
/// copies copy nothing, and each step constructs the member that it uses.
template <class SupplyScratch, class RelocaliserScratch, class Expected>
union FrameScratch {
  FrameScratch() {}
  FrameScratch(const FrameScratch&) {}
  FrameScratch& operator=(const FrameScratch&) { return *this; }
  ~FrameScratch() = default;

  SearchScratch search;
  SupplyScratch supply;
  RelocaliserScratch relocaliser;
  Expected expected;
};

}  // namespace cairn
