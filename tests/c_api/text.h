#pragma once

/* Text output of C programs for every target, without stdio. */

#include <stdint.h>

#include "cairn/port/port.h"

static inline void write_decimal(uint64_t value) {
  char digits[21];
  int at = 20;
  digits[at] = '\0';
  do {
    digits[--at] = (char)('0' + value % 10U);
    value /= 10U;
  } while (value != 0U);
  cairn_port_write(digits + at);
}

static inline void write_hex64(uint64_t value) {
  char digits[17];
  for (int i = 0; i < 16; ++i) digits[i] = "0123456789abcdef"[value >> (60 - 4 * i) & 15U];
  digits[16] = '\0';
  cairn_port_write(digits);
}
