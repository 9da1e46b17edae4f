#pragma once

/// What the ports of bare-metal targets share: the memory of an image as firmware.ld lays it out,
/// and the way from reset to main().

#include <stdint.h>

/// Symbols of firmware.ld.
extern uint32_t cairn_stack_limit[];
extern uint32_t cairn_stack_top[];
extern uint32_t cairn_data_load[];
extern uint32_t cairn_data_start[];
extern uint32_t cairn_data_end[];
extern uint32_t cairn_bss_start[];
extern uint32_t cairn_bss_end[];
extern uint32_t cairn_code_start[];
extern uint32_t cairn_code_end[];
extern uint32_t cairn_ram_end[];
extern uint32_t cairn_frame_ram_start[];
extern uint32_t cairn_frame_ram_end[];

/// Lowest part of the stack that memory protection keeps out of reach. No frame of the program may
/// be larger, or it could step over the guard.
enum { kStackGuardBytes = 4096, kNullGuardBytes = 1024 };

/// Of the CPU's port: stack and null guards, and the tick counter.
void cpu_guards_start(void);
void cpu_ticks_start(void);

/// First C code after reset.
__attribute__((noreturn)) void image_start(void);

/// Whether an address lies in the stack's guard.
int image_in_stack_guard(uint32_t address);
