#pragma once

/* The Cortex-M7's data cache, for double_buffer.h; CMSIS has the same as
   SCB_InvalidateDCache_by_Addr(). */

#include <stdint.h>

static inline void cortex_m7_invalidate(void* at, uint32_t bytes) {
  volatile uint32_t* const dcimvac = (volatile uint32_t*)0xE000EF5CU;
  __asm volatile("dsb" ::: "memory");
  for (uint32_t line = 0; line < bytes; line += 32) *dcimvac = (uint32_t)at + line;
  __asm volatile("dsb\n isb" ::: "memory");
}
