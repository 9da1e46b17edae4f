#pragma once

/** @file
 * Camera tracking from video alone by a window of keyframes, for video that nobody tuned for:
 * sturdier than cairn_handheld_..., with the same frames and units. The map's frame is the first
 * camera; lengths are in a unit of the map's own. What left the view is remembered, and found again
 * after a loss; it cannot be saved. */

#include "cairn/c_api/objects.h"
#include "cairn/c_api/sizes.h"
#include "cairn/c_api/types.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct cairn_window cairn_window;

/** Memory for one tracker: place it where you like. */
typedef union cairn_window_memory {
  int64_t alignment;
  uint8_t bytes[CAIRN_WINDOW_BYTES];
} cairn_window_memory;

/** How a gyroscope is mounted and how good it is, for cairn_window_add_angular_rate(). */
typedef struct cairn_gyro_parameters {
  float qw, qx, qy, qz; /**< turns vectors of its axes to those of the camera; a unit quaternion */
  float noise_density;  /**< rad/s/sqrt(Hz) */
  float bias_sigma_radps; /**< standard deviation of each axis' bias at the start */
  float bias_walk;        /**< rad/s/sqrt(s) */
  float time_sigma_s;     /**< standard deviation of the stamps' offset from the frames' */
  float range_radps;      /**< an axis that reads this or more is saturated */
} cairn_gyro_parameters;

/** A sample of a gyroscope. */
typedef struct cairn_angular_rate {
  int64_t t_us;                    /**< of the frames' clock, but for an offset that is estimated */
  float x_radps, y_radps, z_radps; /**< about the sensor's own axes */
} cairn_angular_rate;

/** Whether a gyroscope turns as the pictures do. */
typedef enum cairn_gyro_trust {
  CAIRN_GYRO_UNPROVEN = 0, /**< the camera has not turned enough, or they agree badly */
  CAIRN_GYRO_AGREES,
  CAIRN_GYRO_CONTRADICTED /**< it is mounted otherwise than told, or its stamps are wrong: it is not
                             used */
} cairn_gyro_trust;

/** What is known of a gyroscope. */
typedef struct cairn_gyro {
  cairn_gyro_trust trust;
  float difference; /**< of its turns from the pictures': 0 none, 1 no better than nothing, 4
                       opposite */
  float bias_x_radps, bias_y_radps, bias_z_radps; /**< camera axes */
  float bias_sigma_radps;
  float time_offset_s; /**< by which its stamps are late */
  float time_offset_sigma_s;
  uint32_t samples, refused, saturated, gaps;
} cairn_gyro;

/** The settings that programs change; all others are those of docs/reference/parameters.md. */
typedef struct cairn_window_parameters {
  float sigma_px;      /**< standard deviation of a measured pixel, of a picture 640 wide */
  float focal_sigma;   /**< how well the focal length is known, relative: a guess 0.2, exactly 0 */
  int32_t work_limit;  /**< units of work a frame */
  int64_t max_step_us; /**< a longer gap between frames is not integrated */
  uint64_t seed;       /**< of RANSAC */
  cairn_gyro_parameters gyro; /**< where there is one */
  float row_time_s;    /**< rolling shutter: from a row of the picture to the next; 0: none */
  float column_time_s; /**< the same of a picture turned by 90 degrees, column to column */
} cairn_window_parameters;

/** Parameters as the tracker has them by default. */
cairn_window_parameters cairn_window_default_parameters(void);

/** Makes a tracker in `memory` (at least CAIRN_WINDOW_BYTES, aligned to CAIRN_ALIGNMENT).
 * `parameters` may be NULL: the defaults. On an error `*window` is NULL: CAIRN_INVALID_ARGUMENT
 * for memory that is too small or not aligned; CAIRN_BAD_CONFIG for an impossible camera or
 * parameter. */
cairn_status cairn_window_initialise(void* memory, size_t bytes, const cairn_camera* camera,
                                     const cairn_window_parameters* parameters,
                                     cairn_window** window);

/** Starts anew with an empty map. */
cairn_status cairn_window_reset(cairn_window* window);

/** Takes a gyroscope's sample (50 to 2,000 Hz, at times of its own); those up to a frame's time
 * come before the frame. Nothing has to be said beforehand: without samples the video alone is
 * used. Refused and counted: CAIRN_NON_FINITE_INPUT, CAIRN_INVALID_ARGUMENT (beyond 200 rad/s),
 * CAIRN_DUPLICATE, CAIRN_TIME_BACKWARDS, CAIRN_TIME_GAP (a jump that the next sample has not
 * confirmed). CAIRN_GATED: saturated, taken as a gap. */
cairn_status cairn_window_add_angular_rate(cairn_window* window, const cairn_angular_rate* sample);

/** Whether it turns as the pictures do, its bias and its time offset. */
cairn_status cairn_window_get_gyro(const cairn_window* window, cairn_gyro* gyro);

/** As cairn_vehicle_process_frame(). */
cairn_status cairn_window_process_frame(cairn_window* window, const cairn_image* image,
                                        int64_t t_us, cairn_report* report);

/** As cairn_vehicle_set_work_limit(). */
cairn_status cairn_window_set_work_limit(cairn_window* window, int32_t units);

/** As cairn_vehicle_set_ticks(). */
cairn_status cairn_window_set_ticks(cairn_window* window, cairn_read_ticks read, void* context);

/** As cairn_handheld_get_covariance(). */
cairn_status cairn_window_get_covariance(const cairn_window* window, float covariance[36]);

/** The focal length as it is estimated, a factor on the one that was told, and its standard
 * deviation; cairn_window_draw() and the landmarks go by it. */
cairn_status cairn_window_get_focal_scale(const cairn_window* window, float* scale, float* sigma);

/** The landmarks that are followed, as cairn_vehicle_get_landmarks(); at most
 * CAIRN_WINDOW_MAX_LANDMARKS. */
cairn_status cairn_window_get_landmarks(const cairn_window* window, cairn_landmark* landmarks,
                                        size_t capacity, size_t* count);

cairn_status cairn_window_get_health(const cairn_window* window, cairn_health* health);

/** As cairn_vehicle_hash(). */
uint64_t cairn_window_hash(const cairn_window* window);

/** As cairn_handheld_place_object(). */
cairn_status cairn_window_place_object(const cairn_window* window, cairn_objects* objects);

/** As cairn_handheld_place_object_at(). */
cairn_status cairn_window_place_object_at(const cairn_window* window, cairn_objects* objects,
                                          float x_px, float y_px);

/** As cairn_vehicle_draw(). */
cairn_status cairn_window_draw(const cairn_window* window, cairn_objects* objects,
                               const cairn_canvas* canvas, int32_t* drawn);

#ifdef __cplusplus
}
#endif
