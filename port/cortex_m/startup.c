// Reset and vectors of Cortex-M firmware: FPU, memory, stack paint, guards, constructors, main.

#include <stddef.h>
#include <stdint.h>

#include "cairn/port/port.h"

#include "cortex_m.h"
#include "semihost.h"

typedef void (*Constructor)(void);
extern const Constructor cairn_init_array_start[];
extern const Constructor cairn_init_array_end[];

int main(int argc, char** argv);

enum { kCommandLineBytes = 512, kMaxArguments = 16 };
static const uint32_t kStackPaint = 0xA5A5A5A5U;

static char command_line[kCommandLineBytes];
static char* arguments[kMaxArguments + 1];

static int split_command_line(void) {
  if (semihost_command_line(command_line, kCommandLineBytes) != 0) return 0;
  int count = 0;
  char* at = command_line;
  while (count < kMaxArguments) {
    while (*at == ' ') ++at;
    if (*at == '\0') break;
    arguments[count++] = at;
    while (*at != '\0' && *at != ' ') ++at;
    if (*at == ' ') *at++ = '\0';
  }
  arguments[count] = NULL;
  return count;
}

static void initialise_memory(void) {
  const uint32_t* source = cairn_data_load;
  for (uint32_t* to = cairn_data_start; to < cairn_data_end; ++to) *to = *source++;
  for (uint32_t* to = cairn_bss_start; to < cairn_bss_end; ++to) *to = 0;
}

void cortex_m_paint_stack(void) {
  const uint32_t own_frame_words = 32;
  uint32_t* const end = (uint32_t*)__builtin_frame_address(0) - own_frame_words;
  for (uint32_t* word = cairn_stack_limit; word < end; ++word)
    *(volatile uint32_t*)word = kStackPaint;
}

uint32_t cairn_port_stack_used_bytes(void) {
  const uint32_t* word = cairn_stack_limit + kStackGuardBytes / 4;
  while (word < cairn_stack_top && *word == kStackPaint) ++word;
  return (uint32_t)((const char*)cairn_stack_top - (const char*)word);
}

uint32_t cairn_port_stack_size_bytes(void) {
  return (uint32_t)((const char*)cairn_stack_top - (const char*)cairn_stack_limit) -
         kStackGuardBytes;
}

__attribute__((noreturn, used)) void cortex_m_start(void) {
  initialise_memory();
  cortex_m_paint_stack();
  cortex_m_guards_start();
  cortex_m_ticks_start();
  for (const Constructor* each = cairn_init_array_start; each < cairn_init_array_end; ++each) {
    (*each)();
  }
  const int argc = split_command_line();
  semihost_exit(main(argc, arguments));
}

// The FPU must be on before any C code: compilers save its registers in prologues.
__attribute__((naked, noreturn, used)) void Reset_Handler(void) {
  __asm volatile(
      "ldr r0, =0xE000ED88\n"
      "ldr r1, [r0]\n"
      "orr r1, r1, #0xF00000\n"
      "str r1, [r0]\n"
      "dsb\n"
      "isb\n"
      "b   cortex_m_start\n");
}

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
      "b     cortex_m_fault\n");
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
