// 32-bit down-counter of the CMSDK timer on Arm's MPS2 boards. The board's toolchain file gives
// CAIRN_BOARD_TIMER_BASE and CAIRN_BOARD_TIMER_HZ.

#include "cairn/port/port.h"

#include "cortex_m.h"

#define TIMER_CONTROL REGISTER32(CAIRN_BOARD_TIMER_BASE + 0x0U)
#define TIMER_VALUE REGISTER32(CAIRN_BOARD_TIMER_BASE + 0x4U)
#define TIMER_RELOAD REGISTER32(CAIRN_BOARD_TIMER_BASE + 0x8U)

void cpu_ticks_start(void) {
  TIMER_CONTROL = 0;
  TIMER_RELOAD = 0xFFFFFFFFU;
  TIMER_VALUE = 0xFFFFFFFFU;
  TIMER_CONTROL = 1;
}

uint32_t cairn_port_ticks(void) {
  return ~TIMER_VALUE;
}

uint32_t cairn_port_ticks_per_second(void) {
  return CAIRN_BOARD_TIMER_HZ;
}
