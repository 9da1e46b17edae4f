#pragma once

#include "cairn/map/map_file.hpp"
#include "cairn/map/shared_map.hpp"

namespace cairn {

/// Module "map building and updating" (paper A, section 3): keeps the library, the long memory
/// beside the filter's active landmarks. It admits the landmarks that the tracker archives,
/// replaces those with the lowest retention score (MapLibrary), counts how often the tracker found
/// a landmark that it searched for, and publishes snapshots.
///
/// Runs in slices: on one thread after each frame, or in a task of lower priority than the
/// tracker's.
template <class Config>
class MapBuilder {
 public:
  using Map = SharedMap<Config>;
  using Library = typename Map::Library;

  /// Handles at most `max_messages` messages and publishes the library if it changed; returns how
  /// many. 0 while the tracker still reads the copy that is needed next: call again later.
  /// Cost: one copy of the library after each publication, three passes over it a message.
  int run(Map& map, int max_messages) {
    if (map.messages.front() == nullptr) return 0;
    Library* library = map.exchange.begin_edit();
    if (library == nullptr) return 0;
    const std::uint32_t before = library->revision();
    int done = 0;
    for (; done < max_messages; ++done) {
      const typename Map::Message* message = map.messages.front();
      if (message == nullptr) break;
      take(*message, *library);
      map.messages.pop();
    }
    if (library->revision() != before) map.exchange.publish();
    return done;
  }

  /// Replaces the library by a saved map and publishes it. kBudgetExceeded while the tracker still
  /// reads the copy that is needed next; otherwise as load_map(). On an error nothing changes.
  Status load(Map& map, const ByteSource& source, MapFileInfo& info) {
    Library* library = map.exchange.begin_edit();
    if (library == nullptr) return Status::kBudgetExceeded;
    const Status status = load_map(source, *library, info);
    if (ok(status)) {
      map.exchange.publish();
    } else {
      map.exchange.discard();
    }
    return status;
  }

  /// Writes the library as the builder has it. Errors: as save_map().
  Status save(Map& map, LandmarkId next_id, const ByteSink& sink) const {
    const Library* library = map.exchange.acquire();
    if (library == nullptr) return Status::kBudgetExceeded;
    const Status status = save_map(*library, next_id, sink);
    map.exchange.release();
    return status;
  }

  /// Admissions, replacements and refusals so far.
  const Health& health() const { return health_; }

 private:
  void take(const typename Map::Message& message, Library& library) {
    using Kind = typename Map::Message::Kind;
    if (message.kind != Kind::kStore) {
      // A landmark may have been replaced since the tracker saw it.
      static_cast<void>(library.record(message.id, message.kind == Kind::kFound));
      return;
    }
    const Status status = library.find(message.landmark.id) < 0
                              ? library.insert(message.landmark, health_)
                              : library.update(message.landmark);
    if (!ok(status) && status != Status::kFull) ++health_.landmarks_refused;
  }

  Health health_;
};

}  // namespace cairn
