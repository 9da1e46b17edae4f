// From reset to main() on bare metal: memory, stack paint, guards, constructors, arguments.

#include "image.h"

#include <stddef.h>

#include "cairn/port/port.h"

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

static void paint_stack(void) {
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

int image_in_stack_guard(uint32_t address) {
  const uint32_t limit = (uint32_t)cairn_stack_limit;
  return address >= limit && address < limit + kStackGuardBytes;
}

__attribute__((noreturn, used)) void image_start(void) {
  initialise_memory();
  paint_stack();
  cpu_guards_start();
  cpu_ticks_start();
  for (const Constructor* each = cairn_init_array_start; each < cairn_init_array_end; ++each) {
    (*each)();
  }
  const int argc = split_command_line();
  semihost_exit(main(argc, arguments));
}

static void write_hex(const char* name, uint32_t value) {
  char digits[] = "0x00000000";
  for (int i = 0; i < 8; ++i) digits[2 + i] = "0123456789abcdef"[(value >> (28 - 4 * i)) & 15U];
  cairn_port_write(name);
  cairn_port_write(digits);
}

void cairn_port_fault_hook(const struct CairnFault* fault) {
  static const char* const names[] = {"stack-overflow", "null-access", "memory", "bus",
                                      "usage",          "other"};
  cairn_port_write("FAULT ");
  cairn_port_write(names[fault->kind]);
  write_hex(" pc=", fault->pc);
  write_hex(" lr=", fault->lr);
  write_hex(" address=", fault->address);
#ifdef __riscv
  write_hex(" mcause=", fault->status);
#else
  write_hex(" cfsr=", fault->status);
#endif
  cairn_port_write("\n");
  semihost_exit(125);
}
