#pragma once

namespace cairn {

/// sum += a * b, the product rounded before the addition.
template <class T>
inline void multiply_add(T& sum, T a, T b) {
  sum += a * b;
}

// One instruction where the core has a vmla that costs no more than a vmul (Cortex-M7; on M4 and
// M33 it takes three cycles). It rounds the product, so results are equal to the bit. GCC 12 does
// not write it by itself.
#if defined(__ARM_ARCH_7EM__) && defined(__ARM_FP) && (__ARM_FP & 8)
inline void multiply_add(float& sum, float a, float b) {
  __asm__("vmla.f32 %0, %1, %2" : "+t"(sum) : "t"(a), "t"(b));
}
#endif

}  // namespace cairn
