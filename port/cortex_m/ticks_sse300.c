// System counter of Arm's SSE-300 subsystem (MPS3 AN547): 64 bits, counts up. The lower word is
// read through its non-secure status frame; the secure control frame switches it on.

#include "cairn/port/port.h"

#include "cortex_m.h"

#define COUNTER_CONTROL REGISTER32(0x58100000U)
#define COUNTER_VALUE_LOW REGISTER32(0x48101000U)

void cpu_ticks_start(void) {
  COUNTER_CONTROL |= 1U;
}

uint32_t cairn_port_ticks(void) {
  return COUNTER_VALUE_LOW;
}

uint32_t cairn_port_ticks_per_second(void) {
  return CAIRN_BOARD_TIMER_HZ;
}
