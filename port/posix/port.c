#define _POSIX_C_SOURCE 200809L

#include "cairn/port/port.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

uint32_t cairn_port_ticks(void) {
  struct timespec now;
  if (clock_gettime(CLOCK_MONOTONIC, &now) != 0) return 0;
  return (uint32_t)((uint64_t)now.tv_sec * 1000000000U + (uint64_t)now.tv_nsec);
}

uint32_t cairn_port_ticks_per_second(void) {
  return 1000000000U;
}

uint32_t cairn_port_critical_enter(void) {
  // A process has no interrupts; programs with several threads bring their own lock.
  return 0;
}

void cairn_port_critical_exit(uint32_t state) {
  (void)state;
}

void cairn_port_write(const char* text) {
  fputs(text, stdout);
}

void cairn_port_fault_hook(const struct CairnFault* fault) {
  fprintf(stderr, "FAULT kind=%d pc=0x%08" PRIx32 " address=0x%08" PRIx32 "\n", (int)fault->kind,
          fault->pc, fault->address);
  fflush(NULL);
  _Exit(125);
}

uint32_t cairn_port_stack_used_bytes(void) {
  return 0;
}

uint32_t cairn_port_stack_size_bytes(void) {
  return 0;
}
