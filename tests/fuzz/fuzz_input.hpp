#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <new>

#include "cairn/base/hash.hpp"

/// Ends the fuzzing with a finding where a promise of docs/reference/robustness-promises.md does
/// not hold.
#define PROMISE(number, holds)                                                              \
  do {                                                                                      \
    if (!(holds)) {                                                                         \
      std::fprintf(stderr, "%s:%d: promise %d is broken: %s\n", __FILE__, __LINE__, number, \
                   #holds);                                                                 \
      std::abort();                                                                         \
    }                                                                                       \
  } while (false)

extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*malloc_hook)(const volatile void*,
                                                                             std::size_t),
                                                         void (*free_hook)(const volatile void*));

namespace cairn::fuzz {

/// Allocations so far, of everything on this thread: libFuzzer has one of its own.
inline std::uint64_t& allocations() {
  thread_local std::uint64_t count = 0;
  return count;
}

/// Counts allocations from here on.
inline void count_allocations() {
  static const int installed = __sanitizer_install_malloc_and_free_hooks(
      [](const volatile void*, std::size_t) { ++allocations(); }, [](const volatile void*) {});
  static_cast<void>(installed);
}

/// Promise 7 for what is called while one exists.
class NoAllocation {
 public:
  NoAllocation() : before_(allocations()) {}
  ~NoAllocation() { PROMISE(7, allocations() == before_); }
  NoAllocation(const NoAllocation&) = delete;
  NoAllocation& operator=(const NoAllocation&) = delete;

 private:
  std::uint64_t before_;
};

/// The fuzzer's bytes as numbers; zeros after their end.
class Input {
 public:
  Input(const std::uint8_t* bytes, std::size_t count) : next_(bytes), left_(count) {}

  bool empty() const { return left_ == 0; }
  std::size_t left() const { return left_; }
  const std::uint8_t* rest() const { return next_; }

  std::uint8_t byte() {
    if (left_ == 0) return 0;
    --left_;
    return *next_++;
  }
  std::uint32_t word() {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i) value = value << 8U | byte();
    return value;
  }
  int below(int bound) { return byte() % bound; }
  int between(int low, int high) {
    return low + static_cast<int>(word() % static_cast<std::uint32_t>(high - low + 1));
  }
  bool flag() { return (byte() & 1U) != 0; }

  /// In [low, high] mostly, any float sometimes.
  float number(float low, float high) {
    const std::uint8_t kind = byte();
    if (kind < 220) return low + (high - low) * static_cast<float>(kind) / 219.0F;
    return wild();
  }
  float wild() {
    static const float edges[] = {0.0F,
                                  -0.0F,
                                  1.0F,
                                  -1.0F,
                                  1e-3F,
                                  1e3F,
                                  -1e3F,
                                  1e5F,
                                  1e6F,
                                  1e9F,
                                  -1e9F,
                                  1e-9F,
                                  1e-20F,
                                  1e20F,
                                  1e30F,
                                  1e38F,
                                  -1e38F,
                                  1e-38F,
                                  1e-45F,
                                  3.14159274F,
                                  -3.14159274F,
                                  1.5707964F,
                                  4096.0F,
                                  2147483648.0F,
                                  std::numeric_limits<float>::max(),
                                  std::numeric_limits<float>::infinity(),
                                  -std::numeric_limits<float>::infinity(),
                                  std::numeric_limits<float>::quiet_NaN()};
    constexpr auto kEdges = static_cast<std::uint8_t>(sizeof edges / sizeof edges[0]);
    const std::uint8_t kind = byte();
    if (kind < kEdges) return edges[kind];
    const std::uint32_t bits = word();
    float value = 0.0F;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  std::int64_t time() {
    static const std::int64_t edges[] = {0,
                                         1,
                                         -1,
                                         1000000,
                                         3600000000LL,
                                         -3600000000LL,
                                         std::int64_t{1} << 32,
                                         std::int64_t{1} << 53,
                                         std::numeric_limits<std::int64_t>::max(),
                                         std::numeric_limits<std::int64_t>::min()};
    constexpr auto kEdges = static_cast<std::uint8_t>(sizeof edges / sizeof edges[0]);
    const std::uint8_t kind = byte();
    if (kind < kEdges) return edges[kind];
    return static_cast<std::int32_t>(word());
  }

 private:
  const std::uint8_t* next_;
  std::size_t left_;
};

/// Exactly the bytes that a view of a picture may touch: the last row has no padding.
struct ExactPicture {
  std::unique_ptr<std::uint8_t[]> bytes;
  int width;
  int height;
  int stride;

  ExactPicture(int w, int h, int s, Input& input) : width(w), height(h), stride(s) {
    const std::size_t count =
        static_cast<std::size_t>(h - 1) * static_cast<std::size_t>(s) + static_cast<std::size_t>(w);
    bytes.reset(new std::uint8_t[count]);
    std::uint32_t state = input.word() | 1U;
    const std::uint8_t contrast = input.byte();
    for (std::size_t i = 0; i < count; ++i) {
      state = state * 1664525U + 1013904223U;
      bytes[i] = static_cast<std::uint8_t>((state >> 24U) > contrast ? 200U : 40U);
    }
  }
};

/// An object as it was before a call, for promise 3. Most calls are accepted, so its hash is taken
/// after a refusal alone: hashes of a whole tracker would take longer than its calls.
template <class Object>
class Before {
 public:
  explicit Before(const Object& object) : object_(object) { copy_of_bytes(object, memory()); }

  bool unchanged() const {
    if (std::memcmp(memory(), &object_, sizeof(Object)) == 0) return true;
    return hash_of(*reinterpret_cast<const Object*>(memory())) == hash_of(object_);
  }
  const Object& object() const { return *reinterpret_cast<const Object*>(memory()); }

 private:
  static void copy_of_bytes(const Object& from, std::uint8_t* to) {
    std::memcpy(to, static_cast<const void*>(&from), sizeof(Object));
  }
  static std::uint64_t hash_of(const Object& object) {
    Hash64 hash;
    object.hash(hash);
    return hash.value();
  }
  static std::uint8_t* memory() {
    alignas(Object) static std::uint8_t bytes[sizeof(Object)];
    return bytes;
  }

  const Object& object_;
};

/// Steps with the fuzzer's bytes. `Run` lies in one place for all executions and is built there
/// anew: memory of its own for each would come from fresh pages.
template <class Run>
void run_steps(Input& input, int steps) {
  alignas(Run) static std::uint8_t memory[sizeof(Run)];
  Run* const run = new (memory) Run(input);
  for (int i = 0; i < steps && !input.empty(); ++i) run->step(input);
  run->~Run();
}

/// Steps of one of three runs with the fuzzer's bytes, the first of which says of which.
template <class First, class Second, class Third>
int run_one_of(const std::uint8_t* bytes, std::size_t size, int steps) {
  count_allocations();
  Input input(bytes, size);
  switch (input.below(3)) {
    case 0:
      run_steps<First>(input, steps);
      break;
    case 1:
      run_steps<Second>(input, steps);
      break;
    default:
      run_steps<Third>(input, steps);
      break;
  }
  return 0;
}

}  // namespace cairn::fuzz
