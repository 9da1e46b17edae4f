// Reset and vectors of Cortex-M firmware.

#include <stdint.h>

#include "cairn/port/port.h"

#include "cortex_m.h"

#if __ARM_ARCH >= 7

// The FPU must be on before any C code: compilers save its registers in prologues.
__attribute__((naked, noreturn, used)) void Reset_Handler(void) {
  __asm volatile(
      "ldr r0, =0xE000ED88\n"
      "ldr r1, [r0]\n"
      "orr r1, r1, #0xF00000\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
      "b   image_start\n");
}

#else

// Unaligned accesses trap: the emulated core, which is larger, would allow them (CCR.UNALIGN_TRP).
__attribute__((naked, noreturn, used)) void Reset_Handler(void) {
  __asm volatile(
      ".syntax unified\n"
      "ldr  r0, =0xE000ED14\n"
      "ldr  r1, [r0]\n"
      "movs r2, #8\n"
      "orrs r1, r2\n"
      "str  r1, [r0]\n"
      "ldr  r0, =image_start\n"
      "bx   r0\n");
}

#endif

// The stack may be what failed, so the rest runs on a fresh one.
__attribute__((naked, used)) static void fault_exception(void) {
  __asm volatile(
      "cpsid i\n"
#if __ARM_ARCH >= 8
      "movs  r0, #0\n"
      "msr   msplim, r0\n"
#endif
      "mrs   r0, msp\n"
      "ldr   r1, =cairn_stack_top\n"
      "msr   msp, r1\n"
      "ldr   r1, =cortex_m_fault\n"
      "bx    r1\n");
}

uint32_t cairn_port_critical_enter(void) {
  uint32_t mask;
  __asm volatile("mrs %0, primask\n cpsid i" : "=r"(mask)::"memory");
  return mask;
}

void cairn_port_critical_exit(uint32_t state) {
  __asm volatile("msr primask, %0" ::"r"(state) : "memory");
}

union Vector {
  const uint32_t* stack;
  void (*handler)(void);
};

#define FAULT \
  { .handler = fault_exception }

// System exceptions alone: the port enables no interrupt.
__attribute__((section(".vectors"), used)) static const union Vector vectors[16] = {
    {.stack = cairn_stack_top},
    {.handler = Reset_Handler},
    FAULT,
    FAULT,
    FAULT,
    FAULT,
    FAULT,
    FAULT,
    FAULT,
    FAULT,
    FAULT,
    FAULT,
    FAULT,
    FAULT,
    FAULT,
    FAULT,
};
