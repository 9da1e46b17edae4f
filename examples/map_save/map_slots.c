#include "map_slots.h"

#include <string.h>

enum { kMostProgramBytes = 32 };

static uint32_t crc32(uint32_t crc, const uint8_t* bytes, size_t count) {
  crc = ~crc;
  for (size_t i = 0; i < count; ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0xEDB88320U & (0U - (crc & 1U)));
  }
  return ~crc;
}

static uint32_t u32(const uint8_t* b) {
  return (uint32_t)b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

static void put_u32(uint8_t* b, uint32_t value) {
  for (int i = 0; i < 4; ++i) b[i] = (uint8_t)(value >> (8 * i));
}

/* The data begins where flash can be programmed apart from the head. */
static uint32_t data_offset(const struct map_flash* flash) {
  return flash->program_bytes > MAP_SLOT_HEAD_BYTES ? flash->program_bytes : MAP_SLOT_HEAD_BYTES;
}

/* Sequence number, size and checksum of a slot whose head and data are whole. */
static bool is_whole(const struct map_flash* flash, int slot, uint32_t* sequence, uint32_t* size) {
  uint8_t head[MAP_SLOT_HEAD_BYTES];
  if (!flash->read(flash->context, slot, 0, head, sizeof head)) return false;
  if (u32(head + 12) != crc32(0, head, 12)) return false;
  *sequence = u32(head);
  *size = u32(head + 4);
  const uint32_t start = data_offset(flash);
  if (*size > flash->slot_bytes - start) return false;
  uint32_t crc = 0;
  for (uint32_t at = 0; at < *size;) {
    uint8_t piece[64];
    const uint32_t left = *size - at;
    const uint32_t count = left < sizeof piece ? left : (uint32_t)sizeof piece;
    if (!flash->read(flash->context, slot, start + at, piece, count)) return false;
    crc = crc32(crc, piece, count);
    at += count;
  }
  return crc == u32(head + 8);
}

/* The slot of the newest whole map, or -1. Sequence numbers are compared as distances, so that they
   may wrap. */
static int newest(const struct map_flash* flash, uint32_t* sequence, uint32_t* size) {
  int found = -1;
  for (int slot = 0; slot < MAP_SLOTS; ++slot) {
    uint32_t number = 0;
    uint32_t bytes = 0;
    if (!is_whole(flash, slot, &number, &bytes)) continue;
    if (found >= 0 && (int32_t)(number - *sequence) <= 0) continue;
    found = slot;
    *sequence = number;
    *size = bytes;
  }
  return found;
}

/* Gathers bytes to pieces that flash can be programmed in. */
struct stream {
  const struct map_flash* flash;
  int slot;
  uint32_t at; /* where the next piece goes */
  uint32_t size;
  uint32_t crc;
  uint8_t piece[kMostProgramBytes];
  uint32_t filled;
};

static bool flush(struct stream* stream) {
  const struct map_flash* flash = stream->flash;
  if (stream->filled == 0) return true;
  memset(stream->piece + stream->filled, 0xFF, flash->program_bytes - stream->filled);
  if (stream->at + flash->program_bytes > flash->slot_bytes) return false;
  if (!flash->program(flash->context, stream->slot, stream->at, stream->piece,
                      flash->program_bytes)) {
    return false;
  }
  stream->at += flash->program_bytes;
  stream->filled = 0;
  return true;
}

static bool take(void* context, const uint8_t* bytes, size_t count) {
  struct stream* stream = context;
  stream->crc = crc32(stream->crc, bytes, count);
  stream->size += (uint32_t)count;
  for (size_t i = 0; i < count; ++i) {
    stream->piece[stream->filled++] = bytes[i];
    if (stream->filled == stream->flash->program_bytes && !flush(stream)) return false;
  }
  return true;
}

static bool write_head(struct stream* stream, uint32_t sequence) {
  uint8_t head[kMostProgramBytes];
  memset(head, 0xFF, sizeof head);
  put_u32(head, sequence);
  put_u32(head + 4, stream->size);
  put_u32(head + 8, stream->crc);
  put_u32(head + 12, crc32(0, head, 12));
  const struct map_flash* flash = stream->flash;
  const uint32_t step = flash->program_bytes;
  for (uint32_t at = 0; at < MAP_SLOT_HEAD_BYTES; at += step) {
    if (!flash->program(flash->context, stream->slot, at, head + at, step)) return false;
  }
  return true;
}

cairn_status map_slots_save(const struct map_flash* flash, map_writer writer, void* map) {
  const uint32_t step = flash->program_bytes;
  if (step == 0 || step > kMostProgramBytes || (step & (step - 1)) != 0 ||
      flash->slot_bytes < data_offset(flash)) {
    return CAIRN_INVALID_ARGUMENT;
  }
  uint32_t sequence = 0;
  uint32_t size = 0;
  const int old = newest(flash, &sequence, &size);
  struct stream stream = {.flash = flash, .slot = old == 0 ? 1 : 0, .at = data_offset(flash)};
  if (!flash->erase(flash->context, stream.slot)) return CAIRN_BUDGET_EXCEEDED;
  const cairn_status status = writer(map, take, &stream);
  if (status != CAIRN_OK) return status;
  return flush(&stream) && write_head(&stream, sequence + 1) ? CAIRN_OK : CAIRN_BUDGET_EXCEEDED;
}

cairn_status map_slots_open(const struct map_flash* flash, int* slot, uint32_t* size) {
  uint32_t sequence = 0;
  *slot = newest(flash, &sequence, size);
  return *slot >= 0 ? CAIRN_OK : CAIRN_NOT_FOUND;
}

bool map_slots_read(void* context, uint32_t offset, uint8_t* bytes, size_t size) {
  const struct map_slot_reader* reader = context;
  const struct map_flash* flash = reader->flash;
  return flash->read(flash->context, reader->slot, data_offset(flash) + offset, bytes, size);
}
