#include "log_file.h"

#include <string.h>

#include "cairn/port/files.h"

enum { kHeaderBytes = 148, kOdometryBytes = 20, kFrameHeadBytes = 20, kCrcBytes = 4 };

static bool get(int32_t file, uint8_t* bytes, uint32_t count) {
  return cairn_file_read(file, bytes, count) == (int32_t)count;
}

static uint32_t u32(const uint8_t* b) {
  return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static uint64_t u64(const uint8_t* b) {
  return u32(b) | (uint64_t)u32(b + 4) << 32;
}

static float f32(const uint8_t* b) {
  const uint32_t bits = u32(b);
  float value = 0.0F;
  memcpy(&value, &bits, sizeof value);
  return value;
}

static void decode_header(const uint8_t* b, struct log_header* header) {
  const bool with_focal = b[0] == 5;
  header->handheld = b[2] == 1;
  header->window = b[3] == 4;
  header->ackermann = b[4] == 1;
  header->adaptive_fading = b[5] == 1;
  header->camera.width = b[6] | b[7] << 8;
  header->camera.height = b[8] | b[9] << 8;
  header->focal_sigma = with_focal ? (float)(b[10] | b[11] << 8) / 10000.0F : 0.0F;
  header->fading = f32(b + 12);
  header->seed = u64(b + 16);
  header->start.t_us = (int64_t)u64(b + 24);
  cairn_camera* c = &header->camera;
  float* const camera[] = {&c->fx, &c->fy, &c->cx, &c->cy, &c->k1, &c->k2, &c->p1, &c->p2, &c->k3};
  for (int i = 0; i < 9; ++i) *camera[i] = f32(b + 32 + 4 * i);
  cairn_transform* T = &header->T_vehicle_camera;
  float* const mounting[] = {&T->qw, &T->qx, &T->qy, &T->qz, &T->x, &T->y, &T->z};
  for (int i = 0; i < 7; ++i) *mounting[i] = f32(b + 68 + 4 * i);
  header->speed_sigma_mps = f32(b + 96);
  header->turn_sigma = f32(b + 100);
  header->wheelbase_m = f32(b + 104);
  header->odometry_period_s = f32(b + 108);
  header->start.x_m = f32(b + 116);
  header->start.y_m = f32(b + 120);
  header->start.heading_rad = f32(b + 124);
  header->start.position_variance = f32(b + 128);
  header->start.heading_variance = f32(b + 132);
}

bool log_open(const char* path, int32_t* file, struct log_header* header) {
  uint8_t start[16];
  uint8_t bytes[kHeaderBytes];
  uint8_t crc[kCrcBytes];
  *file = cairn_file_open(path);
  if (*file < 0) return false;
  if (!get(*file, start, sizeof start) || memcmp(start, "CAIRNLOG", 8) != 0 || start[8] != 1 ||
      u32(start + 12) != kHeaderBytes || !get(*file, bytes, kHeaderBytes) ||
      !get(*file, crc, kCrcBytes)) {
    return false;
  }
  memset(header, 0, sizeof *header);
  decode_header(bytes, header);
  return true;
}

static enum log_event read_odometry(int32_t file, cairn_odometry* sample) {
  uint8_t b[kOdometryBytes + kCrcBytes];
  if (!get(file, b, sizeof b)) return LOG_DAMAGED;
  sample->t_us = (int64_t)u64(b);
  sample->kind = u32(b + 8) == 1U ? CAIRN_ACKERMANN : CAIRN_TWIST;
  sample->speed_mps = f32(b + 12);
  sample->turn = f32(b + 16);
  return LOG_ODOMETRY;
}

static enum log_event read_frame(int32_t file, uint32_t size, struct log_frame* frame,
                                 uint8_t* pixels, uint32_t capacity) {
  uint8_t head[kFrameHeadBytes];
  uint8_t crc[kCrcBytes];
  const uint32_t count = size - kFrameHeadBytes;
  if (size < kFrameHeadBytes || count > capacity || !get(file, head, sizeof head) ||
      !get(file, pixels, count) || !get(file, crc, sizeof crc)) {
    return LOG_DAMAGED;
  }
  frame->t_us = (int64_t)u64(head);
  frame->number = u32(head + 8);
  frame->work_limit = (int32_t)u32(head + 16);
  return LOG_FRAME;
}

enum log_event log_next(int32_t file, cairn_odometry* sample, struct log_frame* frame,
                        uint8_t* pixels, uint32_t capacity) {
  uint8_t head[8];
  if (!get(file, head, sizeof head)) return LOG_DAMAGED;
  const uint32_t size = u32(head + 4);
  switch (head[0]) {
    case 2:
      return size == kOdometryBytes ? read_odometry(file, sample) : LOG_DAMAGED;
    case 3:
      return read_frame(file, size, frame, pixels, capacity);
    case 4:
      return LOG_END;
    default:
      return LOG_DAMAGED;
  }
}
