#pragma once

#include <cstdint>

#include "cairn/port/port.h"

/// Text output of target programs without stdio, which needs a heap on bare metal.
namespace cairn_test {

inline void write(const char* text) {
  cairn_port_write(text);
}

inline void write_decimal(std::uint64_t value) {
  char digits[21];
  int at = 20;
  digits[at] = '\0';
  do {
    digits[--at] = static_cast<char>('0' + value % 10U);
    value /= 10U;
  } while (value != 0U);
  write(digits + at);
}

inline void write_hex64(std::uint64_t value) {
  char digits[17];
  for (int i = 0; i < 16; ++i) {
    digits[i] = "0123456789abcdef"[(value >> static_cast<unsigned>(60 - 4 * i)) & 15U];
  }
  digits[16] = '\0';
  write(digits);
}

inline bool equal_text(const char* a, const char* b) {
  while (*a != '\0' && *a == *b) {
    ++a;
    ++b;
  }
  return *a == *b;
}

/// Value after `name` among the arguments (`--name value`), or `fallback`.
inline const char* argument(int argc, char** argv, const char* name, const char* fallback) {
  for (int i = 1; i + 1 < argc; ++i) {
    if (equal_text(argv[i], name)) return argv[i + 1];
  }
  return fallback;
}

/// Decimal number at the start of `text`, at most 1e9.
inline int parse_decimal(const char* text) {
  int value = 0;
  for (; *text >= '0' && *text <= '9' && value < 100000000; ++text)
    value = 10 * value + *text - '0';
  return value;
}

}  // namespace cairn_test
