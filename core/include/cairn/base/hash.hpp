#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

namespace cairn {

/// FNV-1a 64-bit over the values fed to it: the fingerprint of a result. Byte order is fixed
/// (little endian), so the same values give the same hash on every target. Never feed NaN: its bits
/// differ between CPUs.
class Hash64 {
 public:
  /// Any fixed-width integer (1, 4 or 8 bytes), int and bool. A template, because which of int and
  /// long std::int32_t is differs between targets.
  template <class Integer, std::enable_if_t<std::is_integral<Integer>::value, bool> = true>
  void add(Integer value) {
    static_assert(sizeof(Integer) == 1 || sizeof(Integer) == 4 || sizeof(Integer) == 8,
                  "hash values of 1, 4 or 8 bytes");
    const auto bits = static_cast<std::uint64_t>(value);
    for (unsigned shift = 0; shift < 8U * sizeof(Integer); shift += 8U) {
      mix(static_cast<std::uint8_t>(bits >> shift));
    }
  }
  void add(float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  void add(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    add(bits);
  }
  void add_bytes(const std::uint8_t* bytes, int count) {
    for (int i = 0; i < count; ++i) mix(bytes[i]);
  }

  std::uint64_t value() const { return value_; }

 private:
  void mix(std::uint8_t byte) { value_ = (value_ ^ byte) * 1099511628211ULL; }

  std::uint64_t value_ = 14695981039346656037ULL;
};

}  // namespace cairn
