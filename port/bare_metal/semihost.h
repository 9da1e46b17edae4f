#pragma once

/// Semihosting, Arm's (BKPT 0xAB) and RISC-V's (EBREAK between two shifts): requests to the
/// debugger or emulator.

#include <stdint.h>

enum SemihostOperation {
  SEMIHOST_OPEN = 1,
  SEMIHOST_CLOSE = 2,
  SEMIHOST_WRITE0 = 4,
  SEMIHOST_READ = 6,
  SEMIHOST_SEEK = 10,
  SEMIHOST_FLEN = 12,
  SEMIHOST_GET_CMDLINE = 21,
  SEMIHOST_EXIT_EXTENDED = 32
};

int32_t semihost_call(enum SemihostOperation operation, const void* argument);

/// Command line of the program into `buffer`; 0, or -1 when there is none.
int32_t semihost_command_line(char* buffer, uint32_t size);

/// Ends the program with `status` as the emulator's exit status.
__attribute__((noreturn)) void semihost_exit(int32_t status);
