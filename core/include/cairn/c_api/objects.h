#pragma once

/** @file
 * Virtual objects: one shape at up to eight fixed places in a map. */

#include "cairn/c_api/sizes.h"
#include "cairn/c_api/types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cairn_objects cairn_objects;

/** Memory for the objects of one map. */
typedef union cairn_objects_memory {
  int64_t alignment;
  uint8_t bytes[CAIRN_OBJECTS_BYTES];
} cairn_objects_memory;

/** Objects in the shape of a cairn, `height_m` tall (> 0), none placed yet. On an error `*objects`
 * is NULL: CAIRN_INVALID_ARGUMENT for the memory or the height. */
cairn_status cairn_objects_initialise(void* memory, size_t bytes, float height_m,
                                      cairn_objects** objects);

/** Puts one at a place of the map. CAIRN_FULL, CAIRN_NON_FINITE_INPUT, CAIRN_BAD_CONFIG (no
 * rotation). */
cairn_status cairn_objects_place(cairn_objects* objects, const cairn_transform* T_map_object);

/** How many are placed. */
cairn_status cairn_objects_count(const cairn_objects* objects, int32_t* count);

/** Where the object `index` stands, from 0 in the order of their placing. CAIRN_NOT_FOUND: there is
 * none. */
cairn_status cairn_objects_get_place(const cairn_objects* objects, int32_t index,
                                     cairn_transform* T_map_object);

/** Nothing was drawn for a while and there is room: the time to place another. False for NULL. */
bool cairn_objects_wants_one(const cairn_objects* objects);

#ifdef __cplusplus
}
#endif
