#pragma once

#include <atomic>
#include <cstdint>

namespace cairn {

/// Messages from one writer to one reader, either of which may be a thread, a task or an interrupt;
/// neither waits. All storage inside. Cost of a call: one copy of a message.
template <class Message, int Capacity>
class SpscRing {
  static_assert(Capacity > 0 && (Capacity & (Capacity - 1)) == 0, "a power of two");

 public:
  SpscRing() = default;
  /// Copies are for when neither side is at work.
  SpscRing(const SpscRing& other) { *this = other; }
  SpscRing& operator=(const SpscRing& other) {
    if (this == &other) return *this;
    for (int i = 0; i < Capacity; ++i) messages_[i] = other.messages_[i];
    written_.store(other.written_.load());
    read_.store(other.read_.load());
    return *this;
  }
  ~SpscRing() = default;

  /// Writer. False, and nothing changed, when full.
  bool push(const Message& message) {
    const std::uint32_t written = written_.load(std::memory_order_relaxed);
    if (written - read_.load(std::memory_order_acquire) >= kSize) return false;
    messages_[written % kSize] = message;
    written_.store(written + 1, std::memory_order_release);
    return true;
  }

  /// Reader: the oldest message, nullptr when there is none. Valid until pop().
  const Message* front() const {
    const std::uint32_t read = read_.load(std::memory_order_relaxed);
    if (read == written_.load(std::memory_order_acquire)) return nullptr;
    return &messages_[read % kSize];
  }
  /// Reader. Only after front() gave a message.
  void pop() { read_.store(read_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

 private:
  static constexpr std::uint32_t kSize = static_cast<std::uint32_t>(Capacity);

  Message messages_[Capacity];
  std::atomic<std::uint32_t> written_{0};
  std::atomic<std::uint32_t> read_{0};
};

}  // namespace cairn
