// Stack and null guards. ARMv6-M and ARMv7-M: two no-access MPU regions on top of the default map.
// ARMv8-M has no "no access" for privileged code, so there only what the program owns is mapped,
// and the stack limit register watches the stack.

#include "cortex_m.h"

#define MPU_CTRL REGISTER32(0xE000ED94U)
#define MPU_RNR REGISTER32(0xE000ED98U)
#define MPU_RBAR REGISTER32(0xE000ED9CU)
#define MPU_RASR_OR_RLAR REGISTER32(0xE000EDA0U)
#define MPU_MAIR0 REGISTER32(0xE000EDC0U)
#define SHCSR REGISTER32(0xE000ED24U)

static void enable_fault_exceptions(void) {
  const uint32_t memory_bus_usage = 7U << 16U;
  SHCSR |= memory_bus_usage;
  __asm volatile("dsb\n isb" ::: "memory");
}

#if __ARM_ARCH <= 7

static void forbid(uint32_t region, uint32_t base, uint32_t log2_bytes) {
  const uint32_t execute_never = 1U << 28U;
  const uint32_t enable = 1U;
  MPU_RNR = region;
  MPU_RBAR = base;
  MPU_RASR_OR_RLAR = execute_never | ((log2_bytes - 1U) << 1U) | enable;
}

void cpu_guards_start(void) {
  forbid(0, 0, 10);
  forbid(1, (uint32_t)cairn_stack_limit, 12);
  MPU_CTRL = 5U;  // enable, default map for the rest
  enable_fault_exceptions();
}

#else

enum Access { kReadWrite = 0, kReadOnly = 2 };
enum Memory { kNormal = 0, kDevice = 1 };

static void allow(uint32_t region, uint32_t first, uint32_t end, enum Access access,
                  uint32_t execute_never, enum Memory memory) {
  MPU_RNR = region;
  MPU_RBAR = (first & ~31U) | ((uint32_t)access << 1U) | execute_never;
  MPU_RASR_OR_RLAR = ((end - 1U) & ~31U) | ((uint32_t)memory << 1U) | 1U;
}

void cpu_guards_start(void) {
  MPU_MAIR0 = 0x000000FFU | (0x04U << 8U);  // 0: write-back memory, 1: device nGnRE
  allow(0, (uint32_t)cairn_code_start, (uint32_t)cairn_code_end, kReadOnly, 0, kNormal);
  allow(1, (uint32_t)cairn_stack_limit, (uint32_t)cairn_ram_end, kReadWrite, 1, kNormal);
  allow(2, (uint32_t)cairn_frame_ram_start, (uint32_t)cairn_frame_ram_end, kReadWrite, 1, kNormal);
  allow(3, 0x40000000U, 0x60000000U, kReadWrite, 1, kDevice);
  MPU_CTRL = 1U;
  const uint32_t limit = (uint32_t)cairn_stack_limit + kStackGuardBytes;
  __asm volatile("msr msplim, %0" ::"r"(limit));
  enable_fault_exceptions();
}

#endif
