// Memory for the tests' own containers and reference solutions on boards; the code under test uses
// none. Blocks of four sizes to an octave, each with its size in front, go back to a list per size.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>

#include "cairn/port/port.h"

namespace {

constexpr std::size_t kMemoryBytes = std::size_t{15} << 20;

struct alignas(16) Header {
  int size_class;
};
constexpr std::size_t kHeaderBytes = sizeof(Header);

struct Free {
  Free* next;
};

__attribute__((section(".frames"), aligned(16))) std::uint8_t memory[kMemoryBytes];
std::size_t used = 0;
constexpr int kClasses = 80;
Free* free_blocks[kClasses];

[[noreturn]] void fail(const char* text) {
  cairn_port_write(text);
  const CairnFault fault = {CAIRN_FAULT_OTHER, 0, 0, 0, 0};
  cairn_port_fault_hook(&fault);
}

/// 64, 80, 96, 112, 128, 160 and so on.
constexpr std::size_t block_bytes(int size_class) {
  return static_cast<std::size_t>(4 + size_class % 4) << (4 + size_class / 4);
}
static_assert(block_bytes(kClasses - 1) > kMemoryBytes,
              "a class for every block there is room for");

int class_of(std::size_t bytes) {
  int k = 0;
  while (block_bytes(k) < bytes + kHeaderBytes) ++k;
  return k;
}

}  // namespace

extern "C" {

void* malloc(std::size_t bytes) {
  if (bytes > kMemoryBytes) fail("test allocator: too large\n");
  const int k = class_of(bytes);
  if (Free* block = free_blocks[k]; block != nullptr) {
    free_blocks[k] = block->next;
    return block;
  }
  const std::size_t size = block_bytes(k);
  if (used + size > kMemoryBytes) fail("test allocator: memory exhausted\n");
  auto* const header = new (memory + used) Header{k};
  used += size;
  return header + 1;
}

void free(void* pointer) {
  if (pointer == nullptr) return;
  const int k = (static_cast<const Header*>(pointer) - 1)->size_class;
  free_blocks[k] = new (pointer) Free{free_blocks[k]};
}

void* calloc(std::size_t count, std::size_t bytes) {
  if (bytes != 0 && count > kMemoryBytes / bytes) fail("test allocator: too large\n");
  return std::memset(malloc(count * bytes), 0, count * bytes);
}

void* realloc(void* pointer, std::size_t bytes) {
  if (pointer == nullptr) return malloc(bytes);
  const int k = (static_cast<const Header*>(pointer) - 1)->size_class;
  if (k == class_of(bytes)) return pointer;
  void* const moved = malloc(bytes);
  std::memcpy(moved, pointer, std::min(bytes, block_bytes(k) - kHeaderBytes));
  free(pointer);
  return moved;
}

void abort() {
  fail("abort\n");
}
}

void* operator new(std::size_t bytes) {
  return malloc(bytes);
}
void* operator new[](std::size_t bytes) {
  return malloc(bytes);
}
void* operator new(std::size_t bytes, const std::nothrow_t&) noexcept {
  return malloc(bytes);
}
void operator delete(void* pointer) noexcept {
  free(pointer);
}
void operator delete[](void* pointer) noexcept {
  free(pointer);
}
void operator delete(void* pointer, std::size_t) noexcept {
  free(pointer);
}
void operator delete[](void* pointer, std::size_t) noexcept {
  free(pointer);
}

namespace std {
void __throw_length_error(const char* what) {
  fail(what);
}
void __throw_logic_error(const char* what) {
  fail(what);
}
void __throw_out_of_range(const char* what) {
  fail(what);
}
void __throw_out_of_range_fmt(const char* what, ...) {
  fail(what);
}
void __throw_bad_alloc() {
  fail("bad_alloc");
}
void __throw_bad_array_new_length() {
  fail("bad_array_new_length");
}
void __throw_bad_function_call() {
  fail("bad_function_call");
}
}  // namespace std
