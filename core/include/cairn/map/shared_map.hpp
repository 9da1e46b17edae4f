#pragma once

#include "cairn/base/spsc_ring.hpp"
#include "cairn/map/exchange.hpp"
#include "cairn/map/library.hpp"

namespace cairn {

/// A message of the frame tracker to the map builder.
template <class Landmark>
struct MapMessage {
  enum class Kind : std::uint8_t {
    kStore,     ///< add or renew `landmark`
    kFound,     ///< a landmark of the library was searched and found
    kNotFound,  ///< a landmark of the library was searched and not found
  };
  Kind kind = Kind::kStore;
  LandmarkId id = kNoLandmark;
  Landmark landmark;  ///< kStore alone
};

/// All that FrameTracker and MapBuilder share: a library that the tracker reads through a snapshot,
/// and a ring of messages in the other direction. Neither side ever waits for the other.
template <class Config>
struct SharedMap {
  using Library = MapLibrary<Config>;
  using Landmark = typename Library::Landmark;
  using Message = MapMessage<Landmark>;
  static constexpr int kMessages = 16;

  MapExchange<Library> exchange;
  SpscRing<Message, kMessages> messages;
};

}  // namespace cairn
