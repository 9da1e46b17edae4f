// Cycle counter of the data watchpoint unit: the tick source on silicon (Cortex-M3 and above). QEMU
// does not model it: it reads 0 there. CAIRN_BOARD_TIMER_HZ is the core clock.

#include "cairn/port/port.h"

#include "cortex_m.h"

#define DEMCR REGISTER32(0xE000EDFCU)
#define DWT_CTRL REGISTER32(0xE0001000U)
#define DWT_CYCCNT REGISTER32(0xE0001004U)
#define DWT_LAR REGISTER32(0xE0001FB0U)

void cpu_ticks_start(void) {
  DEMCR |= 1U << 24U;
  DWT_LAR = 0xC5ACCE55U;  // Cortex-M7 locks the unit after reset
  DWT_CYCCNT = 0;
  DWT_CTRL |= 1U;
}

uint32_t cairn_port_ticks(void) {
  return DWT_CYCCNT;
}

uint32_t cairn_port_ticks_per_second(void) {
  return CAIRN_BOARD_TIMER_HZ;
}
