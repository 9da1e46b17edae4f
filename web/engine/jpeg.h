#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Decodes a JPEG of width x height into grey `pixels` without gaps between rows. In integers: the
 * same pixels on every target. False, `pixels` then unchanged, for anything else, and for pictures
 * larger than 640x480. Its memory is static: one call at a time. */
bool web_decode_jpeg(const uint8_t* bytes, size_t size, int width, int height, uint8_t* pixels);

#ifdef __cplusplus
}
#endif
