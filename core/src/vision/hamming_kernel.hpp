#pragma once

#include <cstdint>
#include <cstring>

#include "cairn/vision/detail/word_dsp.hpp"
#include "cairn/vision/hamming.hpp"

#if defined(__x86_64__) && (defined(__GNUC__) || defined(__clang__))
#define CAIRN_VISION_X86 1
#else
#define CAIRN_VISION_X86 0
#endif

namespace cairn::vision {

/// A bit counter gives the distance of the first 16 bytes and of all 64.

/// Where the CPU has no population count: carry-save adders (Harley and Seal) turn the differing
/// bits of fifteen words into one word each of ones, twos, fours and eights before any is counted.
struct WordCounter {
  __attribute__((noinline)) static int prefix(const Descriptor& a, const Descriptor& b) {
    const std::uint64_t d0 = difference(a, b, 0);
    const std::uint64_t d1 = difference(a, b, 1);
    std::uint32_t twos = 0;
    std::uint32_t ones = 0;
    add(low(d0), high(d0), low(d1), twos, ones);
    return total(bytes(nibbles(ones) + nibbles(high(d1))) + 2 * bytes(nibbles(twos)));
  }

  __attribute__((noinline)) static int whole(const Descriptor& a, const Descriptor& b) {
    std::uint32_t ones = 0;
    std::uint32_t last = 0;
    std::uint32_t twos_a = 0;
    std::uint32_t twos_b = 0;
    std::uint32_t fours_a = 0;
    std::uint32_t fours_b = 0;
    std::uint32_t eights = 0;
    std::uint32_t twos = 0;
    std::uint32_t fours = 0;
    std::uint64_t d = difference(a, b, 0);
    std::uint64_t e = difference(a, b, 1);
    add(low(d), high(d), low(e), twos, ones);
    d = difference(a, b, 2);
    add(ones, high(e), low(d), twos_a, ones);
    e = difference(a, b, 3);
    add(ones, high(d), low(e), twos_b, ones);
    add(twos, twos_a, twos_b, fours, twos);
    d = difference(a, b, 4);
    add(ones, high(e), low(d), twos_a, ones);
    e = difference(a, b, 5);
    add(ones, high(d), low(e), twos_b, ones);
    add(twos, twos_a, twos_b, fours_a, twos);
    d = difference(a, b, 6);
    add(ones, high(e), low(d), twos_a, ones);
    e = difference(a, b, 7);
    add(ones, high(d), low(e), twos_b, ones);
    last = high(e);
    add(twos, twos_a, twos_b, fours_b, twos);
    add(fours, fours_a, fours_b, eights, fours);
    return total(bytes(nibbles(ones) + nibbles(last)) + 2 * bytes(nibbles(twos)) +
                 4 * bytes(nibbles(fours)) + 8 * bytes(nibbles(eights)));
  }

 private:
  static std::uint64_t load(const Descriptor& d, int i) {
#if defined(__ARM_ARCH_ISA_THUMB) && __ARM_ARCH_ISA_THUMB >= 2
    std::uint32_t first = 0;
    std::uint32_t second = 0;
    __asm__("ldrd %0, %1, %2" : "=r"(first), "=r"(second) : "Uv"(d.bytes[8 * i]), "m"(d));
    return first | static_cast<std::uint64_t>(second) << 32U;
#else
    std::uint64_t v = 0;
    std::memcpy(&v, d.bytes + 8 * i, sizeof v);
    return v;
#endif
  }
  static std::uint64_t difference(const Descriptor& a, const Descriptor& b, int i) {
    return load(a, i) ^ load(b, i);
  }
  static std::uint32_t low(std::uint64_t v) {
    return static_cast<std::uint32_t>(v);
  }
  static std::uint32_t high(std::uint64_t v) {
    return static_cast<std::uint32_t>(v >> 32U);
  }

  static void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t& carry,
                  std::uint32_t& sum) {
    const std::uint32_t half = a ^ b;
    carry = (a & b) | (half & c);
    sum = half ^ c;
  }
  /// Bits of each group of four, 0..4 in each nibble. Masks in registers can be combined with
  /// shifted operands.
  static std::uint32_t nibbles(std::uint32_t v) {
    const std::uint32_t ones = keep_in_register(0x55555555U);
    const std::uint32_t pairs = keep_in_register(0x33333333U);
    v -= (v >> 1U) & ones;
    return (v & pairs) + ((v >> 2U) & pairs);
  }
  /// Pairs of nibbles, each below 9, added into bytes.
  static std::uint32_t bytes(std::uint32_t n) {
    const std::uint32_t nibble = keep_in_register(0x0F0F0F0FU);
    return (n & nibble) + ((n >> 4U) & nibble);
  }
  static int total(std::uint32_t sums) {
    return static_cast<int>(ByteAdder()(sums, 0));
  }
};

/// Where __builtin_popcountll is an instruction, or the best that the compiler has.
struct PopulationCounter {
  __attribute__((always_inline)) static int prefix(const Descriptor& a, const Descriptor& b) {
    return count(a, b, 0) + count(a, b, 1);
  }
  __attribute__((always_inline)) static int whole(const Descriptor& a, const Descriptor& b) {
    return prefix(a, b) + count(a, b, 2) + count(a, b, 3) + count(a, b, 4) + count(a, b, 5) +
           count(a, b, 6) + count(a, b, 7);
  }

 private:
  __attribute__((always_inline)) static int count(const Descriptor& a, const Descriptor& b, int i) {
    std::uint64_t x = 0;
    std::uint64_t y = 0;
    std::memcpy(&x, a.bytes + 8 * i, sizeof x);
    std::memcpy(&y, b.bytes + 8 * i, sizeof y);
    return __builtin_popcountll(x ^ y);
  }
};

/// Not a distance: never taken for a match.
inline constexpr int kTooFar = 513;

__attribute__((always_inline)) inline void offer(HammingMatch& match, int index, int distance) {
  if (distance >= match.second_distance) return;
  if (distance < match.distance) {
    match.second_distance = match.distance;
    match.distance = distance;
    match.index = index;
  } else {
    match.second_distance = distance;
  }
}

/// Distance, or kTooFar when the prefix is over the limit.
template <class Counter>
__attribute__((always_inline)) inline int cascade(const Descriptor& a, const Descriptor& b,
                                                  int prefix_limit) {
  if (prefix_limit < kNoPrefixLimit && Counter::prefix(a, b) > prefix_limit) return kTooFar;
  return Counter::whole(a, b);
}

template <class Counter>
__attribute__((always_inline)) inline HammingMatch match_with(const Descriptor& query,
                                                              Span<Descriptor> candidates,
                                                              int prefix_limit) {
  HammingMatch match;
  for (int i = 0; i < candidates.size; ++i) {
    offer(match, i, cascade<Counter>(query, candidates[i], prefix_limit));
  }
  return match;
}

}  // namespace cairn::vision
