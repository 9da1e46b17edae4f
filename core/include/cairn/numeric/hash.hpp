#pragma once

#include <cstdint>
#include <cstring>

namespace cairn {

/// FNV-1a 64-bit over the values fed to it: the fingerprint of a result. Byte order is fixed
/// (little endian), so the same values give the same hash on every target. Never feed NaN: its bits
/// differ between CPUs.
class Hash64 {
 public:
  void add(std::uint8_t value) { mix(value); }
  void add(std::uint32_t value) {
    for (int shift = 0; shift < 32; shift += 8) mix(static_cast<std::uint8_t>(value >> shift));
  }
  void add(std::uint64_t value) {
    for (int shift = 0; shift < 64; shift += 8) mix(static_cast<std::uint8_t>(value >> shift));
  }
  void add(std::int32_t value) { add(static_cast<std::uint32_t>(value)); }
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
