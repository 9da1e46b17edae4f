#pragma once

/* Frames by DMA, tracked without a copy: the camera fills one buffer while the tracker reads the
   other. For one core, with the interrupt above the tracker. */

#include <stdbool.h>
#include <stdint.h>

#include "cairn/cairn.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { CACHE_LINE_BYTES = 32 };

/* Both buffers begin at a cache line and are whole lines long: invalidating one must not throw away
   what the CPU wrote beside it. */
struct double_buffer {
  uint8_t* frames[2];
  int32_t width, height;
  /* Drops what the cache holds of `bytes` from `at` on; both multiples of CACHE_LINE_BYTES. Empty
     where there is no data cache, or where the buffers lie in memory that is not cached. */
  void (*invalidate)(void* at, uint32_t bytes);
  volatile int ready;     /* buffer with a frame that was not taken yet, or -1 */
  volatile int held;      /* buffer that the tracker reads, or -1 */
  volatile int64_t t_us;  /* of the ready frame */
  volatile uint32_t lost; /* frames that were filled and never taken */
};

/* False where a buffer or its size is not whole cache lines. */
bool double_buffer_init(struct double_buffer* buffers, uint8_t* first, uint8_t* second,
                        int32_t width, int32_t height,
                        void (*invalidate)(void* at, uint32_t bytes));

/* From the interrupt at a frame's end: buffer `filled` is complete, taken at `t_us` (the middle of
   the exposure). Returns the buffer that the camera fills next: the other one, or the same where
   the tracker still reads the other. */
int double_buffer_filled(struct double_buffer* buffers, int filled, int64_t t_us);

/* The newest frame; false when there is none yet. It stays until double_buffer_release(). With
   interrupts off, as the comment in the source says. */
bool double_buffer_take(struct double_buffer* buffers, cairn_image* image, int64_t* t_us);
void double_buffer_release(struct double_buffer* buffers);

/* For cameras that send YUV 4:2:2 (Y first), by DMA line by line into two small line buffers: the
   grey half of a line, written to its row of the frame while the next line comes. The line buffer
   is invalidated first; the frame is written by the CPU and needs no upkeep. */
void take_yuv_line(const struct double_buffer* buffers, int frame, int32_t row, uint8_t* line);

#ifdef __cplusplus
}
#endif
