// Included first into every source of the core on bare metal: a call to the heap that survives
// optimisation is a compile error. Fixed-size Eigen operations can hide one: where the host uses
// alloca, a target without it calls malloc.
#pragma once

#include <stdlib.h>

#if defined(__GNUC__) && !defined(__clang__)
#define CAIRN_NO_HEAP __attribute__((error("the core uses no heap")))
#ifdef __cplusplus
extern "C" {
#endif
void* malloc(size_t) CAIRN_NO_HEAP;
void* calloc(size_t, size_t) CAIRN_NO_HEAP;
void* realloc(void*, size_t) CAIRN_NO_HEAP;
void free(void*) CAIRN_NO_HEAP;
#ifdef __cplusplus
}
#endif
#endif
