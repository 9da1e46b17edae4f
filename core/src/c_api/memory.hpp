#pragma once

#include <cstddef>
#include <cstdint>

#include "cairn/c_api/sizes.h"

namespace cairn::c_api {

/// Whether an object of `needed` bytes can be made in memory that a C program hands in.
inline bool fits(const void* memory, std::size_t bytes, std::size_t needed) {
  return memory != nullptr && bytes >= needed &&
         reinterpret_cast<std::uintptr_t>(memory) % CAIRN_ALIGNMENT == 0;
}

}  // namespace cairn::c_api

/// The constants of sizes.h against the object: never too small, and not much too large. Where
/// this fails, enter a new one there, half a KB above the size that the message names.
template <std::size_t Size, std::size_t Constant>
constexpr bool cairn_size_is_current() {
  static_assert(Size <= Constant, "a constant of cairn/c_api/sizes.h is too small");
  static_assert(Constant - Size < 4096, "a constant of cairn/c_api/sizes.h is much too large");
  return true;
}
