#include "pose_frame.h"

#include <string.h>

static uint16_t crc16(const uint8_t* bytes, size_t count) {
  uint16_t crc = 0xFFFFU;
  for (size_t i = 0; i < count; ++i) {
    crc = (uint16_t)(crc ^ bytes[i] << 8);
    for (int bit = 0; bit < 8; ++bit) {
      crc = (uint16_t)((crc & 0x8000U) != 0 ? (unsigned)crc << 1 ^ 0x1021U : (unsigned)crc << 1);
    }
  }
  return crc;
}

static void put(uint8_t* to, uint64_t value, int bytes) {
  for (int i = 0; i < bytes; ++i) to[i] = (uint8_t)(value >> (8 * i));
}

static void put_float(uint8_t* to, float value) {
  uint32_t bits = 0;
  memcpy(&bits, &value, sizeof bits);
  put(to, bits, 4);
}

size_t cobs_frame(const uint8_t* bytes, size_t count, uint8_t* out) {
  size_t code_at = 0; /* where the distance to the next zero is written */
  size_t to = 1;
  for (size_t i = 0; i < count; ++i) {
    if (bytes[i] == 0) {
      out[code_at] = (uint8_t)(to - code_at);
      code_at = to++;
    } else {
      out[to++] = bytes[i];
    }
  }
  out[code_at] = (uint8_t)(to - code_at);
  out[to++] = 0;
  return to;
}

size_t pose_frame(const cairn_report* report, uint8_t out[POSE_FRAME_BYTES]) {
  const cairn_transform* T = &report->T_map_camera;
  const float values[7] = {T->qw, T->qx, T->qy, T->qz, T->x, T->y, T->z};
  uint8_t packet[POSE_PACKET_BYTES];
  packet[0] = 1;
  packet[1] = (uint8_t)report->state;
  packet[2] = (uint8_t)report->status;
  packet[3] = (uint8_t)(report->inliers < 255 ? report->inliers : 255);
  put(packet + 4, (uint64_t)report->t_us, 8);
  for (int i = 0; i < 7; ++i) put_float(packet + 12 + 4 * i, values[i]);
  put(packet + POSE_PACKET_BYTES - 2, crc16(packet, POSE_PACKET_BYTES - 2), 2);
  return cobs_frame(packet, POSE_PACKET_BYTES, out);
}
