#include "cairn/port/port.h"

#include "cortex_m.h"

#define CFSR REGISTER32(0xE000ED28U)
#define MMFAR REGISTER32(0xE000ED34U)
#define BFAR REGISTER32(0xE000ED38U)

enum {
  kMemoryAccess = 0x1 | 0x2,
  kMemoryStacking = 0x10 | 0x20,
  kMemoryAddressValid = 0x80,
  kBusBits = 0x7F00,
  kBusAddressValid = 0x8000,
  kStackLimit = 0x100000,
  kUsageBits = 0x3EF0000
};

static enum CairnFaultKind classify(const struct CairnFault* fault, int address_known) {
  if ((fault->status & (kMemoryStacking | kStackLimit)) != 0) return CAIRN_FAULT_STACK_OVERFLOW;
  if ((fault->status & (kMemoryAccess | kMemoryAddressValid)) != 0) {
    if (address_known && image_in_stack_guard(fault->address)) return CAIRN_FAULT_STACK_OVERFLOW;
    const int null_data = address_known && fault->address < kNullGuardBytes;
    const int null_call = !address_known && fault->pc < kNullGuardBytes;
    return null_data || null_call ? CAIRN_FAULT_NULL_ACCESS : CAIRN_FAULT_MEMORY;
  }
  if ((fault->status & kBusBits) != 0) return CAIRN_FAULT_BUS;
  if ((fault->status & kUsageBits) != 0) return CAIRN_FAULT_USAGE;
  return CAIRN_FAULT_OTHER;
}

/// `frame`: stack pointer at the exception, with r0-r3, r12, lr, pc, xPSR stacked there if it lies
/// inside the stack.
__attribute__((noreturn, used)) void cortex_m_fault(const uint32_t* frame) {
  struct CairnFault fault = {CAIRN_FAULT_OTHER, 0, 0, 0, CFSR};
  int address_known = 0;
  if (frame >= cairn_stack_limit + kStackGuardBytes / 4 && frame + 8 <= cairn_stack_top) {
    fault.lr = frame[5];
    fault.pc = frame[6];
  }
  if ((fault.status & kMemoryAddressValid) != 0) {
    fault.address = MMFAR;
    address_known = 1;
  } else if ((fault.status & kBusAddressValid) != 0) {
    fault.address = BFAR;
    address_known = 1;
  }
  fault.kind = classify(&fault, address_known);
  cairn_port_fault_hook(&fault);
}
