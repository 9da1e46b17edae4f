#include "double_buffer.h"

#include <stddef.h>

static bool is_whole_lines(uintptr_t value) {
  return value % CACHE_LINE_BYTES == 0;
}

bool double_buffer_init(struct double_buffer* buffers, uint8_t* first, uint8_t* second,
                        int32_t width, int32_t height,
                        void (*invalidate)(void* at, uint32_t bytes)) {
  if (first == NULL || second == NULL || first == second || width <= 0 || height <= 0 ||
      invalidate == NULL || !is_whole_lines((uintptr_t)first) ||
      !is_whole_lines((uintptr_t)second) || !is_whole_lines((uintptr_t)width * (uintptr_t)height)) {
    return false;
  }
  *buffers = (struct double_buffer){.frames = {first, second},
                                    .width = width,
                                    .height = height,
                                    .invalidate = invalidate,
                                    .ready = -1,
                                    .held = -1};
  return true;
}

int double_buffer_filled(struct double_buffer* buffers, int filled, int64_t t_us) {
  const int other = 1 - filled;
  if (buffers->held == other) {
    /* The tracker is slow: the camera overwrites the frame that it has just filled. */
    ++buffers->lost;
    buffers->ready = -1;
    return filled;
  }
  if (buffers->ready == other) ++buffers->lost;
  buffers->ready = filled;
  buffers->t_us = t_us;
  return other;
}

/* The three steps between looking and holding must not be parted by double_buffer_filled(): call
   it with the camera's interrupt off, which is some ten instructions. */
bool double_buffer_take(struct double_buffer* buffers, cairn_image* image, int64_t* t_us) {
  const int ready = buffers->ready;
  if (ready < 0) return false;
  buffers->held = ready;
  buffers->ready = -1;
  *t_us = buffers->t_us;
  uint8_t* const frame = buffers->frames[ready];
  buffers->invalidate(frame, (uint32_t)(buffers->width * buffers->height));
  *image = (cairn_image){frame, buffers->width, buffers->height, buffers->width};
  return true;
}

void double_buffer_release(struct double_buffer* buffers) {
  buffers->held = -1;
}

void take_yuv_line(const struct double_buffer* buffers, int frame, int32_t row, uint8_t* line) {
  const uint32_t width = (uint32_t)buffers->width;
  const uint32_t bytes = (2 * width + CACHE_LINE_BYTES - 1) / CACHE_LINE_BYTES * CACHE_LINE_BYTES;
  buffers->invalidate(line, bytes);
  uint8_t* const to = buffers->frames[frame] + (uint32_t)row * width;
  for (uint32_t x = 0; x < width; ++x) to[x] = line[2 * x];
}
