#pragma once

#include <stdint.h>

#define REGISTER32(address) (*(volatile uint32_t*)(address))

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

/// Lowest part of the stack that the MPU or the stack limit register keeps out of reach. No frame
/// of the program may be larger, or it could step over the guard.
enum { kStackGuardBytes = 4096, kNullGuardBytes = 1024 };

void cortex_m_ticks_start(void);
void cortex_m_guards_start(void);
void cortex_m_paint_stack(void);
