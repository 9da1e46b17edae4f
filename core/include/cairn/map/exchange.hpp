#pragma once

#include <atomic>
#include <cstdint>

#include "cairn/base/status.hpp"

namespace cairn {

/// Two copies of a map between one writer (the map builder) and one reader (the tracker), either of
/// which may be a thread, a task or an interrupt. Neither ever waits: the reader pins the front
/// copy for as long as it needs it, the writer edits the back copy and publishes it by turning a
/// sequence counter. While the reader still pins the copy that the writer needs next, begin_edit
/// answers nullptr and the writer does its work later.
///
/// On one thread the same calls work and begin_edit never fails between two snapshots.
/// `Map` is copied by assignment; no operation allocates.
template <class Map>
class MapExchange {
 public:
  MapExchange() = default;
  /// Copies are for when neither side is at work.
  MapExchange(const MapExchange& other) { *this = other; }
  MapExchange& operator=(const MapExchange& other) {
    if (this == &other) return *this;
    for (int i = 0; i < 2; ++i) maps_[i] = other.maps_[i];
    sequence_.store(other.sequence_.load());
    pinned_.store(other.pinned_.load());
    back_is_current_ = other.back_is_current_;
    return *this;
  }
  ~MapExchange() = default;

  // --- reader ---

  /// The newest published map, unchanged until release(). nullptr only when the writer published
  /// three times during the call, which a writer of lower or equal priority cannot.
  const Map* acquire() {
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const std::uint32_t sequence = sequence_.load();
      pinned_.store(sequence | kPinned);
      if (sequence_.load() == sequence) return &maps_[sequence & 1U];
    }
    pinned_.store(0);
    return nullptr;
  }
  void release() { pinned_.store(0); }

  // --- writer ---

  /// The back copy, equal to the front one at first; nullptr while the reader still pins it.
  /// Cost: one copy of the map after each publish.
  Map* begin_edit() {
    const std::uint32_t front = sequence_.load() & 1U;
    const std::uint32_t back = 1U - front;
    const std::uint32_t pinned = pinned_.load();
    if ((pinned & kPinned) != 0 && (pinned & 1U) == back) return nullptr;
    if (!back_is_current_) {
      maps_[back] = maps_[front];
      back_is_current_ = true;
    }
    return &maps_[back];
  }
  /// Makes the back copy the one that readers get. Only after begin_edit gave it.
  void publish() {
    back_is_current_ = false;
    sequence_.store((sequence_.load() + 1U) & ~kPinned);
  }
  /// Drops what was edited since the last publish.
  void discard() { back_is_current_ = false; }

  /// The newest published map, for when neither side is at work.
  const Map& front() const { return maps_[sequence_.load() & 1U]; }

  /// Number of publications so far (modulo 2^31).
  std::uint32_t sequence() const { return sequence_.load(); }

 private:
  static constexpr std::uint32_t kPinned = 0x80000000U;
  static constexpr int kAttempts = 3;

  Map maps_[2];
  std::atomic<std::uint32_t> sequence_{0};
  std::atomic<std::uint32_t> pinned_{0};
  bool back_is_current_ = false;  // the writer's own
};

}  // namespace cairn
