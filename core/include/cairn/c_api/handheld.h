#pragma once

/** @file
 * Camera tracking from video alone. The map's frame is the first camera; lengths are in a
 * unit of the map's own. */

#include "cairn/c_api/objects.h"
#include "cairn/c_api/sizes.h"
#include "cairn/c_api/types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cairn_handheld cairn_handheld;

/** Memory for one tracker: place it where you like. */
typedef union cairn_handheld_memory {
  int64_t alignment;
  uint8_t bytes[CAIRN_HANDHELD_BYTES];
} cairn_handheld_memory;

/** The settings that programs change; all others are those of docs/reference/parameters.md. */
typedef struct cairn_handheld_parameters {
  float sigma_px;             /**< standard deviation of a measured pixel */
  float least_velocity_noise; /**< of a calm hand, units/s per root s */
  float most_velocity_noise;  /**< of a fast one */
  float least_rate_noise;     /**< rad/s per root s */
  float most_rate_noise;      /**< rad/s per root s */
  float fading_factor;        /**< 1: none; at most 2 */
  bool adaptive_fading;       /**< in place of the fixed factor */
  bool estimate_focal_length; /**< for a calibration that is off by some percent */
  int32_t work_limit;         /**< units of work a frame */
  int64_t max_step_us;        /**< a longer gap between frames is not integrated */
  uint64_t seed;              /**< of RANSAC */
} cairn_handheld_parameters;

/** Parameters as the tracker has them by default. */
cairn_handheld_parameters cairn_handheld_default_parameters(void);

/** Makes a tracker in `memory` (at least CAIRN_HANDHELD_BYTES, aligned to CAIRN_ALIGNMENT).
 * `parameters` may be NULL: the defaults. On an error `*handheld` is NULL: CAIRN_INVALID_ARGUMENT
 * for memory that is too small or not aligned; CAIRN_BAD_CONFIG for an impossible camera or
 * parameter. */
cairn_status cairn_handheld_initialise(void* memory, size_t bytes, const cairn_camera* camera,
                                       const cairn_handheld_parameters* parameters,
                                       cairn_handheld** handheld);

/** Starts anew with an empty map. */
cairn_status cairn_handheld_reset(cairn_handheld* handheld);

/** As cairn_vehicle_process_frame(). */
cairn_status cairn_handheld_process_frame(cairn_handheld* handheld, const cairn_image* image,
                                          int64_t t_us, cairn_report* report);

/** As cairn_vehicle_set_work_limit(). */
cairn_status cairn_handheld_set_work_limit(cairn_handheld* handheld, int32_t units);

/** As cairn_vehicle_set_ticks(). */
cairn_status cairn_handheld_set_ticks(cairn_handheld* handheld, cairn_read_ticks read,
                                      void* context);

/** Covariance of the camera's position (rows 0 to 2, map axes, squared units) and of the rotation
 * vector phi (rows 3 to 5, camera axes, rad^2) with R_true = R exp(phi); row by row. */
cairn_status cairn_handheld_get_covariance(const cairn_handheld* handheld, float covariance[36]);

/** As cairn_vehicle_get_landmarks(). */
cairn_status cairn_handheld_get_landmarks(const cairn_handheld* handheld, cairn_landmark* landmarks,
                                          size_t capacity, size_t* count);

cairn_status cairn_handheld_get_health(const cairn_handheld* handheld, cairn_health* health);

/** As cairn_vehicle_hash(). */
uint64_t cairn_handheld_hash(const cairn_handheld* handheld);

/** Puts an object in front of the camera on the plane on which most features lie.
 * CAIRN_NOT_FOUND while too few features are known well, or too few of them lie on one plane:
 * try again at a later frame. CAIRN_FULL. */
cairn_status cairn_handheld_place_object(const cairn_handheld* handheld, cairn_objects* objects);

/** Puts an object where the ray of a pixel of the last frame meets the plane of the features, or,
 * where they lie on none, at the depth of the feature seen nearest to it. CAIRN_INVALID_ARGUMENT
 * for a pixel outside the image; CAIRN_NOT_FOUND while too few features are known well; CAIRN_FULL.
 */
cairn_status cairn_handheld_place_object_at(const cairn_handheld* handheld, cairn_objects* objects,
                                            float x_px, float y_px);

/** As cairn_vehicle_draw(). */
cairn_status cairn_handheld_draw(const cairn_handheld* handheld, cairn_objects* objects,
                                 const cairn_canvas* canvas, int32_t* drawn);

/** As cairn_vehicle_save_map(), with CAIRN_HANDHELD_MAP_BYTES. */
cairn_status cairn_handheld_save_map(cairn_handheld* handheld, uint8_t* buffer, size_t size,
                                     size_t* used);

/** As cairn_vehicle_load_map(); the tracker is lost until it recognises a place of the map. */
cairn_status cairn_handheld_load_map(cairn_handheld* handheld, const uint8_t* bytes, size_t size);

/** The same, piece by piece. */
cairn_status cairn_handheld_write_map(cairn_handheld* handheld, cairn_write_bytes write,
                                      void* context);
cairn_status cairn_handheld_read_map(cairn_handheld* handheld, cairn_read_bytes read, void* context,
                                     uint32_t size);

#ifdef __cplusplus
}
#endif
