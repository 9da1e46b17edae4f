#pragma once

/* Poses as bytes for a serial line. A packet is 42 bytes, little endian: version 1, state, status,
   inliers (u8 each), time (i64, us), the camera in the map (7 float: w, x, y, z; m), CRC-16
   (CCITT, 0xFFFF) of all before. On the line it is COBS encoded (Cheshire and Baker 1999) and ends
   with a zero byte, so that a reader finds the next packet after any damage. */

#include <stddef.h>
#include <stdint.h>

#include "cairn/cairn.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { POSE_PACKET_BYTES = 42, POSE_FRAME_BYTES = POSE_PACKET_BYTES + 2 };

/* COBS of `count` <= 253 bytes and the closing zero; returns the number of bytes written, which is
   count + 2. */
size_t cobs_frame(const uint8_t* bytes, size_t count, uint8_t* out);

/* The bytes to send for a frame's report; returns POSE_FRAME_BYTES. */
size_t pose_frame(const cairn_report* report, uint8_t out[POSE_FRAME_BYTES]);

#ifdef __cplusplus
}
#endif
