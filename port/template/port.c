// Start of a port to a new board: copy this file, give each function its body for the board, and
// link it with cairn::core. The contracts are in cairn/port/port.h. As it stands it is a port to
// nothing: no counter, no messages, no interrupts to keep out, and a fault stops the program.

#include "cairn/port/port.h"

uint32_t cairn_port_ticks(void) {
  // A cycle counter (DWT->CYCCNT on Cortex-M3 and above) or a free-running timer.
  return 0;
}

uint32_t cairn_port_ticks_per_second(void) {
  return 0;
}

uint32_t cairn_port_critical_enter(void) {
  // Cortex-M: state = __get_PRIMASK(); __disable_irq();
  return 0;
}

void cairn_port_critical_exit(uint32_t state) {
  // Cortex-M: __set_PRIMASK(state);
  (void)state;
}

void cairn_port_write(const char* text) {
  // Blocking UART, SEGGER RTT, a log in RAM.
  (void)text;
}

void cairn_port_fault_hook(const struct CairnFault* fault) {
  // Store *fault where it survives a reset, then reset.
  (void)fault;
  for (;;) {
  }
}

uint32_t cairn_port_stack_used_bytes(void) {
  return 0;
}

uint32_t cairn_port_stack_size_bytes(void) {
  return 0;
}
