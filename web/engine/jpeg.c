#include "jpeg.h"

#include <string.h>

/* stb_image asks for memory; it gets it from here, and all of it is free again after a picture. */
enum { kArenaBytes = 1024 * 1024, kAlignment = 16, kMaxPixels = 640 * 480 };

static union {
  uint64_t alignment;
  uint8_t bytes[kArenaBytes];
} arena;
static size_t arena_used;

static void* take(size_t size) {
  const size_t rounded = (size + kAlignment - 1) / kAlignment * kAlignment;
  if (size > kArenaBytes || rounded > kArenaBytes - arena_used) return NULL;
  void* const start = arena.bytes + arena_used;
  arena_used += rounded;
  return start;
}

static void* take_larger(void* old, size_t old_size, size_t size) {
  void* const larger = take(size);
  if (larger != NULL && old != NULL) memcpy(larger, old, old_size < size ? old_size : size);
  return larger;
}

#define STBI_MALLOC(size) take(size)
#define STBI_REALLOC_SIZED(old, old_size, size) take_larger(old, old_size, size)
#define STBI_FREE(memory) ((void)(memory))
#define STBI_ASSERT(condition) ((void)0)
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_NO_SIMD
#define STBI_NO_THREAD_LOCALS
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb_image.h>

bool web_decode_jpeg(const uint8_t* bytes, size_t size, int width, int height, uint8_t* pixels) {
  int own_width = 0;
  int own_height = 0;
  int components = 0;
  if (bytes == NULL || size > INT32_MAX || width < 1 || height < 1 || width > kMaxPixels / height) {
    return false;
  }
  arena_used = 0;
  if (!stbi_info_from_memory(bytes, (int)size, &own_width, &own_height, &components) ||
      own_width != width || own_height != height || components != 1) {
    return false;
  }
  arena_used = 0;
  const uint8_t* const decoded =
      stbi_load_from_memory(bytes, (int)size, &own_width, &own_height, &components, 1);
  if (decoded == NULL) return false;
  memcpy(pixels, decoded, (size_t)width * (size_t)height);
  return true;
}
