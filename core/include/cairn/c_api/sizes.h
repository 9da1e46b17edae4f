#pragma once

/** @file
 * Capacities and memory of the C interface's objects, for the configuration that is linked:
 * CAIRN_CONFIG_TINY, CAIRN_CONFIG_LARGE, or neither for the default one. Rounded up, so that small
 * changes of a tracker need no new ones; the library is compiled against them. */

#include <stdint.h>

/** Alignment of the memory handed in. */
#define CAIRN_ALIGNMENT 8

#if defined(CAIRN_CONFIG_TINY)
#define CAIRN_MAX_IMAGE_WIDTH 320
#define CAIRN_MAX_IMAGE_HEIGHT 240
#define CAIRN_VEHICLE_BYTES 59904
#define CAIRN_VEHICLE_MAX_LANDMARKS 16 /**< active at a time */
#define CAIRN_VEHICLE_MAP_BYTES 7140   /**< of a full map, saved */
#define CAIRN_HANDHELD_BYTES 54272
#define CAIRN_HANDHELD_MAX_LANDMARKS 16
#define CAIRN_HANDHELD_MAP_BYTES 7140
#define CAIRN_WINDOW_BYTES 135680
#elif defined(CAIRN_CONFIG_LARGE)
#define CAIRN_MAX_IMAGE_WIDTH 1280
#define CAIRN_MAX_IMAGE_HEIGHT 960
#define CAIRN_VEHICLE_BYTES 812544
#define CAIRN_VEHICLE_MAX_LANDMARKS 128 /**< active at a time */
#define CAIRN_VEHICLE_MAP_BYTES 151588  /**< of a full map, saved */
#define CAIRN_HANDHELD_BYTES 174592
#define CAIRN_HANDHELD_MAX_LANDMARKS 50
#define CAIRN_HANDHELD_MAP_BYTES 37924
#define CAIRN_WINDOW_BYTES 272896
#else
#define CAIRN_MAX_IMAGE_WIDTH 640
#define CAIRN_MAX_IMAGE_HEIGHT 480
#define CAIRN_VEHICLE_BYTES 251904
#define CAIRN_VEHICLE_MAX_LANDMARKS 64 /**< active at a time */
#define CAIRN_VEHICLE_MAP_BYTES 37924  /**< of a full map, saved */
#define CAIRN_HANDHELD_BYTES 121344
#define CAIRN_HANDHELD_MAX_LANDMARKS 32
#define CAIRN_HANDHELD_MAP_BYTES 37924
#define CAIRN_WINDOW_BYTES 215040
#endif

#define CAIRN_WINDOW_MAX_LANDMARKS 64 /**< followed at a time */
#define CAIRN_OBJECTS_BYTES 6144
