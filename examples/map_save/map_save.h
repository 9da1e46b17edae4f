#pragma once

#include "map_slots.h"

/* Saves the vehicle's map beside the one before. Errors: as map_slots_save(). */
cairn_status save_map(const struct map_flash* flash, cairn_vehicle* vehicle);

/* Loads the newest map. CAIRN_NOT_FOUND: there is none; otherwise as cairn_vehicle_read_map(). */
cairn_status load_map(const struct map_flash* flash, cairn_vehicle* vehicle);
