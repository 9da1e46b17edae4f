/* Loads the map that the last run saved, drives, and saves it again: call save_map() where your
   vehicle stops, and load_map() after cairn_vehicle_initialise(). The flash is yours to give. */

#include "map_save.h"

static cairn_status write_vehicle(void* vehicle, cairn_write_bytes write, void* context) {
  return cairn_vehicle_write_map(vehicle, write, context);
}

cairn_status save_map(const struct map_flash* flash, cairn_vehicle* vehicle) {
  return map_slots_save(flash, write_vehicle, vehicle);
}

cairn_status load_map(const struct map_flash* flash, cairn_vehicle* vehicle) {
  struct map_slot_reader reader = {flash, -1};
  uint32_t size = 0;
  const cairn_status found = map_slots_open(flash, &reader.slot, &size);
  return found == CAIRN_OK ? cairn_vehicle_read_map(vehicle, map_slots_read, &reader, size) : found;
}
