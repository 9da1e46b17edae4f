#pragma once

/** @file
 * Camera tracking on a planar vehicle, from video and odometry. */

#include "cairn/c_api/objects.h"
#include "cairn/c_api/sizes.h"
#include "cairn/c_api/types.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Vehicle frame: x forward, y left, z up, origin on the floor below the middle of the rear axle.
 */
typedef struct cairn_vehicle cairn_vehicle;

/** Memory for one tracker: place it where you like. */
typedef union cairn_vehicle_memory {
  int64_t alignment;
  uint8_t bytes[CAIRN_VEHICLE_BYTES];
} cairn_vehicle_memory;

/** The settings that programs change; all others are those of docs/reference/parameters.md. */
typedef struct cairn_vehicle_parameters {
  float sigma_speed_mps;      /**< standard deviation of a speed reading */
  float sigma_turn;           /**< of a steering angle, rad, or of a yaw rate, rad/s */
  float wheelbase_m;          /**< for steering angles alone */
  float sample_period_s;      /**< of the odometry */
  float sigma_px;             /**< standard deviation of a measured pixel */
  float floor_sigma_m;        /**< unevenness of the floor; 0: the floor is not used */
  float sigma_pitch_rad;      /**< of the body on its suspension; both 0: it does not tilt */
  float sigma_roll_rad;       /**< car: 0.01 and 0.02; rover: 0.012 and 0.02 */
  float tilt_time_constant_s; /**< in which a tilt returns to 1/e; car: 1, rover: 2 */
  int32_t work_limit;         /**< units of work a frame */
  int64_t max_step_us;        /**< longer without odometry: the motion is unknown */
  uint64_t seed;              /**< of RANSAC */
} cairn_vehicle_parameters;

/** Where the vehicle starts, in the map. */
typedef struct cairn_vehicle_start {
  int64_t t_us;
  float x_m, y_m, heading_rad;
  float position_variance; /**< m^2, of x and of y */
  float heading_variance;  /**< rad^2 */
} cairn_vehicle_start;

typedef enum cairn_odometry_kind { CAIRN_TWIST = 0, CAIRN_ACKERMANN } cairn_odometry_kind;

/** Motion since the sample before it. */
typedef struct cairn_odometry {
  int64_t t_us;
  cairn_odometry_kind kind;
  float speed_mps;
  float turn; /**< CAIRN_TWIST: yaw rate, rad/s; CAIRN_ACKERMANN: steering angle, rad */
} cairn_odometry;

/** The vehicle on the floor of the map. Covariance of (x, y, heading) in the map's axes, row by
 * row: of the vehicle's place in the map, of what the map may be wrong by where it was recognised,
 * and of what calibration leaves. */
typedef struct cairn_vehicle_pose {
  float x_m, y_m, heading_rad;
  float covariance[9];
} cairn_vehicle_pose;

/** Parameters as the tracker has them by default. */
cairn_vehicle_parameters cairn_vehicle_default_parameters(void);

/** Makes a tracker in `memory` (at least CAIRN_VEHICLE_BYTES, aligned to CAIRN_ALIGNMENT), with an
 * empty map. `start` and `parameters` may be NULL: origin at time 0, exactly known, and the
 * defaults. On an error `*vehicle` is NULL: CAIRN_INVALID_ARGUMENT for memory that is too small or
 * not aligned, or a negative variance; CAIRN_BAD_CONFIG for an impossible camera, mounting or
 * parameter; CAIRN_NON_FINITE_INPUT. */
cairn_status cairn_vehicle_initialise(void* memory, size_t bytes, const cairn_camera* camera,
                                      const cairn_transform* T_vehicle_camera,
                                      const cairn_vehicle_start* start,
                                      const cairn_vehicle_parameters* parameters,
                                      cairn_vehicle** vehicle);

/** Starts anew at a known pose of the map; the map library is kept. Errors as
 * cairn_vehicle_initialise(). For an empty map initialise again. */
cairn_status cairn_vehicle_reset(cairn_vehicle* vehicle, const cairn_vehicle_start* start);

/** Odometry, in time order. Refused and counted: CAIRN_NON_FINITE_INPUT, CAIRN_INVALID_ARGUMENT,
 * CAIRN_TIME_BACKWARDS, and CAIRN_TIME_GAP for a stamp that is not believed. Taken: CAIRN_GATED (a
 * glitch, bridged), CAIRN_TIME_GAP (samples were missing). */
cairn_status cairn_vehicle_add_odometry(cairn_vehicle* vehicle, const cairn_odometry* sample);

/** Tracks one frame, whose odometry should have been added; `report` may be NULL. Refused and
 * counted, `report` unchanged: CAIRN_INVALID_ARGUMENT (size not the camera's), CAIRN_DUPLICATE,
 * CAIRN_TIME_BACKWARDS, CAIRN_TIME_GAP (stamp not believed). Otherwise report->status is returned.
 * Cost: the work limit. */
cairn_status cairn_vehicle_process_frame(cairn_vehicle* vehicle, const cairn_image* image,
                                         int64_t t_us, cairn_report* report);

/** Units of work that each frame may take from now on. CAIRN_INVALID_ARGUMENT for a negative one.
 */
cairn_status cairn_vehicle_set_work_limit(cairn_vehicle* vehicle, int32_t units);

/** Measures the stages of later frames; `read` NULL: not any more. */
cairn_status cairn_vehicle_set_ticks(cairn_vehicle* vehicle, cairn_read_ticks read, void* context);

cairn_status cairn_vehicle_get_pose(const cairn_vehicle* vehicle, cairn_vehicle_pose* pose);

/** Active landmarks, at most `capacity`; `*count` is how many were written. */
cairn_status cairn_vehicle_get_landmarks(const cairn_vehicle* vehicle, cairn_landmark* landmarks,
                                         size_t capacity, size_t* count);

cairn_status cairn_vehicle_get_health(const cairn_vehicle* vehicle, cairn_health* health);

/** Fingerprint of the last accepted frame: everything that was decided, equal on every target. 0
 * for NULL. */
uint64_t cairn_vehicle_hash(const cairn_vehicle* vehicle);

/** Puts an object at a place on the floor, `forward_m` ahead and `left_m` to the left. CAIRN_FULL.
 */
cairn_status cairn_vehicle_place_object(const cairn_vehicle* vehicle, cairn_objects* objects,
                                        float forward_m, float left_m);

/** Draws the objects as the last accepted frame sees them; nothing while it is lost. `drawn` may be
 * NULL. CAIRN_INVALID_ARGUMENT for a canvas that has not the camera's size. */
cairn_status cairn_vehicle_draw(const cairn_vehicle* vehicle, cairn_objects* objects,
                                const cairn_canvas* canvas, int32_t* drawn);

/** Writes the map to `buffer`; CAIRN_VEHICLE_MAP_BYTES always suffice. `*used`: bytes written.
 * CAIRN_BUDGET_EXCEEDED: no room; what was written is no valid map. */
cairn_status cairn_vehicle_save_map(cairn_vehicle* vehicle, uint8_t* buffer, size_t size,
                                    size_t* used);

/** Takes a saved map in place of the present one. CAIRN_VERSION_MISMATCH, CAIRN_CORRUPT: nothing
 * changed. */
cairn_status cairn_vehicle_load_map(cairn_vehicle* vehicle, const uint8_t* bytes, size_t size);

/** The same, piece by piece: for memory that cannot be addressed. */
cairn_status cairn_vehicle_write_map(cairn_vehicle* vehicle, cairn_write_bytes write,
                                     void* context);
cairn_status cairn_vehicle_read_map(cairn_vehicle* vehicle, cairn_read_bytes read, void* context,
                                    uint32_t size);

#ifdef __cplusplus
}
#endif
