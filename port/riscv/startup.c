// Reset, traps, guards and ticks of 32-bit RISC-V firmware that stays in machine mode.

#include "cairn/port/port.h"

#include "../bare_metal/image.h"

enum {
  kFetchFault = 1,
  kIllegalInstruction = 2,
  kLoadMisaligned = 4,
  kLoadFault = 5,
  kStoreMisaligned = 6,
  kStoreFault = 7
};

__attribute__((section(".vectors"), naked, noreturn, used)) void Reset_Handler(void) {
  __asm volatile(
      "la   sp, cairn_stack_top\n"
      "la   t0, riscv_trap\n"
      "csrw mtvec, t0\n"
      "j    image_start\n");
}

static enum CairnFaultKind classify(uint32_t cause, uint32_t address) {
  switch (cause) {
    case kFetchFault:
    case kLoadFault:
    case kStoreFault:
      if (image_in_stack_guard(address)) return CAIRN_FAULT_STACK_OVERFLOW;
      return address < kNullGuardBytes ? CAIRN_FAULT_NULL_ACCESS : CAIRN_FAULT_MEMORY;
    case kIllegalInstruction:
    case kLoadMisaligned:
    case kStoreMisaligned:
      return CAIRN_FAULT_USAGE;
    default:
      return CAIRN_FAULT_OTHER;
  }
}

__attribute__((noreturn, used)) void riscv_fault(uint32_t lr) {
  struct CairnFault fault = {CAIRN_FAULT_OTHER, 0, lr, 0, 0};
  __asm volatile("csrr %0, mepc" : "=r"(fault.pc));
  __asm volatile("csrr %0, mtval" : "=r"(fault.address));
  __asm volatile("csrr %0, mcause" : "=r"(fault.status));
  fault.kind = classify(fault.status, fault.address);
  cairn_port_fault_hook(&fault);
}

// The stack may be what failed, so the rest runs on a fresh one.
__attribute__((naked, aligned(4), used)) static void riscv_trap(void) {
  __asm volatile(
      "csrci mstatus, 8\n"
      "mv    a0, ra\n"
      "la    sp, cairn_stack_top\n"
      "j     riscv_fault\n");
}

/// Two locked regions of the physical memory protection without any access; where none matches,
/// machine mode may do all.
void cpu_guards_start(void) {
  const uint32_t stack = (uint32_t)cairn_stack_limit;
  const uint32_t napot_none_locked = 0x98U;
  __asm volatile("csrw pmpaddr0, %0" ::"r"(kNullGuardBytes / 8U - 1U));
  __asm volatile("csrw pmpaddr1, %0" ::"r"((stack >> 2U) | (kStackGuardBytes / 8U - 1U)));
  __asm volatile("csrw pmpcfg0, %0" ::"r"(napot_none_locked << 8U | napot_none_locked));
}

void cpu_ticks_start(void) {}

// Under emulation with -icount the cycle counter counts the guest's nanoseconds, 64 to an
// instruction; on silicon CAIRN_BOARD_TIMER_HZ is the core clock.
uint32_t cairn_port_ticks(void) {
  uint32_t cycles;
  __asm volatile("csrr %0, mcycle" : "=r"(cycles));
  return cycles;
}

uint32_t cairn_port_ticks_per_second(void) {
  return CAIRN_BOARD_TIMER_HZ;
}

uint32_t cairn_port_critical_enter(void) {
  uint32_t status;
  __asm volatile("csrrci %0, mstatus, 8" : "=r"(status)::"memory");
  return status & 8U;
}

void cairn_port_critical_exit(uint32_t state) {
  __asm volatile("csrs mstatus, %0" ::"r"(state) : "memory");
}
