// Breaks one rule of the memory map, as its argument says: the port must end the program in its
// fault hook.

#include <cstdint>

#include "text.hpp"

namespace {

using Function = void (*)();

int overflow(int depth) {
  volatile char block[512];
  block[0] = static_cast<char>(depth);
  return depth > 1000000 ? block[0] : overflow(depth + 1) + block[0];
}

// Seen through a volatile, so that the compiler cannot know it is null.
volatile std::uintptr_t null_address = 0;

}  // namespace

int main(int argc, char** argv) {
  const char* what = argc > 1 ? argv[1] : "";
  if (cairn_test::equal_text(what, "stack-overflow")) return overflow(0);
  if (cairn_test::equal_text(what, "null-read")) {
    return *reinterpret_cast<volatile int*>(null_address);
  }
  if (cairn_test::equal_text(what, "null-write")) {
    *reinterpret_cast<volatile int*>(null_address + 64U) = 1;
    return 0;
  }
  if (cairn_test::equal_text(what, "null-call")) {
    reinterpret_cast<Function>(null_address + 1U)();
    return 0;
  }
  cairn_test::write("usage: port_fault_probe stack-overflow|null-read|null-write|null-call\n");
  return 2;
}
