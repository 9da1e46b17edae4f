#include "semihost.h"

#include "cairn/port/files.h"
#include "cairn/port/port.h"

#ifdef __riscv

// The three instructions are the request: uncompressed, and on one page.
int32_t semihost_call(enum SemihostOperation operation, const void* argument) {
  register int32_t a0 __asm("a0") = (int32_t)operation;
  register const void* a1 __asm("a1") = argument;
  __asm volatile(
      ".option push\n"
      ".option norvc\n"
      ".balign 16\n"
      "slli zero, zero, 0x1f\n"
      "ebreak\n"
      "srai zero, zero, 7\n"
      ".option pop\n"
      : "+r"(a0)
      : "r"(a1)
      : "memory");
  return a0;
}

#else

int32_t semihost_call(enum SemihostOperation operation, const void* argument) {
  register int32_t r0 __asm("r0") = (int32_t)operation;
  register const void* r1 __asm("r1") = argument;
  __asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

#endif

int32_t semihost_command_line(char* buffer, uint32_t size) {
  const uint32_t block[2] = {(uint32_t)buffer, size};
  return semihost_call(SEMIHOST_GET_CMDLINE, block);
}

void semihost_exit(int32_t status) {
  const uint32_t application_exit = 0x20026U;
  const uint32_t block[2] = {application_exit, (uint32_t)status};
  semihost_call(SEMIHOST_EXIT_EXTENDED, block);
  for (;;) {
  }
}

void cairn_port_write(const char* text) {
  semihost_call(SEMIHOST_WRITE0, text);
}

int32_t cairn_file_open(const char* path) {
  uint32_t length = 0;
  while (path[length] != '\0') ++length;
  const uint32_t read_binary = 1;
  const uint32_t block[3] = {(uint32_t)path, read_binary, length};
  return semihost_call(SEMIHOST_OPEN, block);
}

int32_t cairn_file_read(int32_t file, void* buffer, uint32_t size) {
  const uint32_t block[3] = {(uint32_t)file, (uint32_t)buffer, size};
  const int32_t not_read = semihost_call(SEMIHOST_READ, block);
  if (not_read < 0 || (uint32_t)not_read > size) return -1;
  return (int32_t)(size - (uint32_t)not_read);
}

int32_t cairn_file_size(int32_t file) {
  const uint32_t block[1] = {(uint32_t)file};
  return semihost_call(SEMIHOST_FLEN, block);
}

int32_t cairn_file_seek(int32_t file, uint32_t position) {
  const uint32_t block[2] = {(uint32_t)file, position};
  return semihost_call(SEMIHOST_SEEK, block) == 0 ? 0 : -1;
}

void cairn_file_close(int32_t file) {
  const uint32_t block[1] = {(uint32_t)file};
  semihost_call(SEMIHOST_CLOSE, block);
}
