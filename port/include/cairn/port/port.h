#pragma once

/// What a board gives to a program that uses Cairn. The core itself calls none of this: ticks reach
/// it as a `cairn::TickSource`, everything else is for the program around it. To support a board,
/// copy port/template, fill in the bodies and link the result instead of another port.

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Free-running counter for measuring stages. Counts up, wraps at 2^32, never jumps back, and may
/// be read from any context. Resolution of 1 us or better is useful; a board without one returns 0
/// always (measuring off). At most a few dozen cycles. Results never depend on it.
uint32_t cairn_port_ticks(void);

/// Counts of cairn_port_ticks() in one second; 0 when the board has no counter.
uint32_t cairn_port_ticks_per_second(void);

/// Keeps interrupts out until the matching exit, so that a frame or an odometry sample can be
/// handed over whole. Nests: the value returned is given back to cairn_port_critical_exit(). Never
/// held while a frame is processed.
uint32_t cairn_port_critical_enter(void);
void cairn_port_critical_exit(uint32_t state);

/// Writes zero-terminated `text` to wherever the board's messages go (UART, RTT, log); may drop it.
/// Not called by the core, and not from interrupts.
void cairn_port_write(const char* text);

enum CairnFaultKind {
  CAIRN_FAULT_STACK_OVERFLOW,
  CAIRN_FAULT_NULL_ACCESS,  ///< read, write or execute inside the guarded page at address 0
  CAIRN_FAULT_MEMORY,       ///< other access that the MPU forbids
  CAIRN_FAULT_BUS,
  CAIRN_FAULT_USAGE,  ///< undefined instruction, unaligned access, division by zero
  CAIRN_FAULT_OTHER
};

struct CairnFault {
  enum CairnFaultKind kind;
  uint32_t pc;       ///< of the failing instruction, 0 where not known
  uint32_t lr;       ///< return address, 0 where not known
  uint32_t address;  ///< accessed address, 0 where not known
  uint32_t status;   ///< the CPU's own fault status (Cortex-M: CFSR)
};

/// Last function of a program that cannot go on. Called by the port's exception handlers on a fresh
/// stack with interrupts off; must not return. A product stores `fault` and resets; the emulated
/// boards print one line and end with exit status 125.
__attribute__((noreturn)) void cairn_port_fault_hook(const struct CairnFault* fault);

/// Bytes of the main stack that were ever used (high-water mark of a painted stack) and its size; 0
/// where not known.
uint32_t cairn_port_stack_used_bytes(void);
uint32_t cairn_port_stack_size_bytes(void);

#ifdef __cplusplus
}
#endif
