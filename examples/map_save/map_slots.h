#pragma once

/* A map kept in two slots of flash, so that one of them is whole at any time.

   A slot is {sequence number, size, CRC-32 of the data, CRC-32 of these three; u32 each, little
   endian}, then the data. A save erases the slot that is not the newest, writes the data, and the
   16 bytes of the head last: power lost before that leaves the other slot the newest. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "cairn/cairn.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { MAP_SLOTS = 2, MAP_SLOT_HEAD_BYTES = 16 };

/* The board's flash. `program` writes to erased flash; each returns false when it failed. */
struct map_flash {
  bool (*erase)(void* context, int slot);
  bool (*program)(void* context, int slot, uint32_t offset, const uint8_t* bytes, size_t count);
  bool (*read)(void* context, int slot, uint32_t offset, uint8_t* bytes, size_t count);
  void* context;
  uint32_t slot_bytes; /* of each slot, head included */
  uint32_t
      program_bytes; /* flash is programmed in pieces of so many bytes: 1 to 32, a power of 2 */
};

/* Writes a map: gives its bytes to `write`, in order, in pieces of any size. */
typedef cairn_status (*map_writer)(void* map, cairn_write_bytes write, void* context);

/* CAIRN_OK: the map is saved, and newer than any other. CAIRN_BUDGET_EXCEEDED: it has no room, or
   the flash failed; what `map_slots_open` finds is then the map before. Otherwise as `writer`. */
cairn_status map_slots_save(const struct map_flash* flash, map_writer writer, void* map);

/* The newest whole map: its slot and size, or CAIRN_NOT_FOUND. */
cairn_status map_slots_open(const struct map_flash* flash, int* slot, uint32_t* size);

/* A map that map_slots_open() found, as cairn_..._read_map() wants it: `context` is a
   struct map_slot_reader. */
struct map_slot_reader {
  const struct map_flash* flash;
  int slot;
};
bool map_slots_read(void* context, uint32_t offset, uint8_t* bytes, size_t size);

#ifdef __cplusplus
}
#endif
