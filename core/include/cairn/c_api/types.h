#pragma once

/** @file
 * Values that the C interface takes and gives. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Why a call was refused, or what a frame went through. */
typedef enum cairn_status {
  CAIRN_OK = 0,
  CAIRN_INVALID_ARGUMENT, /**< a size, pointer, index or range is outside its documented domain */
  CAIRN_NON_FINITE_INPUT, /**< NaN or infinity came in */
  CAIRN_BAD_CONFIG,       /**< a parameter or calibration value is impossible */
  CAIRN_DUPLICATE,        /**< same time stamp as the last accepted input */
  CAIRN_TIME_BACKWARDS,   /**< older than the last accepted input */
  CAIRN_TIME_GAP,         /**< further ahead than the largest step */
  CAIRN_NOT_INITIALISED,
  CAIRN_NOT_FOUND,
  CAIRN_FULL,
  CAIRN_SINGULAR,
  CAIRN_GATED,        /**< odometry: a glitch, bridged; filter: outside its gate */
  CAIRN_NO_CONSENSUS, /**< too few landmarks agree: the pose is predicted */
  CAIRN_OUT_OF_VIEW,
  CAIRN_DEGENERATE,
  CAIRN_LOW_TEXTURE,      /**< fewer features than tracking needs */
  CAIRN_VERSION_MISMATCH, /**< stored map of another format version or capacity */
  CAIRN_CORRUPT,          /**< stored map fails its length, checksum or value test */
  CAIRN_BUDGET_EXCEEDED,  /**< work limit, buffer or sink has no room */
  CAIRN_LOST,             /**< no pose: tracking is lost */
  CAIRN_REPEATED_IMAGE    /**< the same bytes as the frame before: nothing was measured */
} cairn_status;

/** Stable lower-case name, for logs; "unknown" for a value that is none. */
const char* cairn_status_text(cairn_status status);

/** How far a pose may be trusted (docs/how-to/add-to-your-firmware.md). */
typedef enum cairn_state {
  CAIRN_INITIALISING = 0, /**< not yet confirmed by landmarks */
  CAIRN_TRACKING,         /**< confirmed by landmarks */
  CAIRN_UNCERTAIN,        /**< little more than prediction since the last confirmed frame */
  CAIRN_STATE_LOST        /**< not known; relocalisation goes on by itself */
} cairn_state;

/** What a frame left out because its work limit did not suffice; a later one includes the earlier.
 */
typedef enum cairn_cut {
  CAIRN_CUT_NONE = 0,
  CAIRN_CUT_FEWER_UPDATES,
  CAIRN_CUT_NO_MAPPING,
  CAIRN_CUT_PREDICTION_ONLY
} cairn_cut;

/** What the coefficients of a lens mean (cairn/geometry/camera.hpp). */
typedef enum cairn_lens {
  CAIRN_LENS_RADIAL_TANGENTIAL = 0, /**< OpenCV's; rational where k4, k5 or k6 is not 0 */
  CAIRN_LENS_FISHEYE                /**< Kannala-Brandt k1 to k4; the other ones are 0 */
} cairn_lens;

/** Camera with its lens; px. Pixel (0, 0) is the centre of the first pixel. */
typedef struct cairn_camera {
  float fx, fy, cx, cy;
  float k1, k2, p1, p2, k3;
  int32_t width, height;
  float k4, k5, k6;
  cairn_lens lens;
} cairn_camera;

/** Rigid transform T_a_b: p_a = R p_b + t. Unit Hamilton quaternion (w, x, y, z); m. */
typedef struct cairn_transform {
  float qw, qx, qy, qz;
  float x, y, z;
} cairn_transform;

/** 8-bit grey image; row r starts at data + r * stride. 1 <= width <= stride, 1 <= height <= 4096.
 */
typedef struct cairn_image {
  const uint8_t* data;
  int32_t width, height, stride;
} cairn_image;

/** The same, to be drawn into. */
typedef struct cairn_canvas {
  uint8_t* data;
  int32_t width, height, stride;
} cairn_canvas;

/** Counter for measuring stages; may wrap at 2^32. NULL: nothing is measured. */
typedef uint32_t (*cairn_read_ticks)(void* context);

enum { CAIRN_STAGES = 5 }; /**< preprocess, prediction, features, update and map, drawing */

/** What a frame gave. */
typedef struct cairn_report {
  int64_t t_us;
  cairn_status status;
  cairn_state state;
  cairn_cut cut;
  cairn_transform T_map_camera; /**< the pose, in the map's frame */
  uint32_t stage_ticks[CAIRN_STAGES];
  int32_t searched;    /**< landmarks searched */
  int32_t matches;     /**< of these found */
  int32_t inliers;     /**< of these used by the filter */
  int32_t landmarks;   /**< active landmarks after the frame */
  int32_t reactivated; /**< landmarks taken back from the map library */
  int32_t work;        /**< units of work spent, 1000 instructions of a Cortex-M7 each */
  bool relocalised;
} cairn_report;

/** An active landmark. Position in the map, m; covariance of the filter's estimate in the map's
 * axes, row by row, m^2. */
typedef struct cairn_landmark {
  uint32_t id;
  float position[3];
  float covariance[9];
} cairn_landmark;

/** Everything that was clamped, rejected, reset or dropped since the start
 * (docs/reference/health.md). Counters wrap at 2^32. */
typedef struct cairn_health {
  uint32_t non_finite_inputs;
  uint32_t time_errors;
  uint32_t images_refused;
  uint32_t frame_gaps;
  uint32_t odometry_refused;
  uint32_t odometry_glitches;
  uint32_t odometry_timeouts;
  uint32_t repeated_images;
  uint32_t innovations_used;
  uint32_t innovations_gated;
  uint32_t innovations_singular;
  uint32_t ransac_no_consensus;
  uint32_t landmarks_added;
  uint32_t landmarks_removed;
  uint32_t landmarks_replaced;
  uint32_t landmarks_refused;
  uint32_t candidates_dropped;
  uint32_t corners_dropped;
  uint32_t searches_deferred;
  uint32_t covariance_repairs;
  uint32_t depth_repairs;
  uint32_t reacquisitions;
  uint32_t resets;
  uint32_t losses;
  uint32_t landmarks_archived;
  uint32_t landmarks_reactivated;
  uint32_t map_messages_dropped;
  uint32_t relocalisations;
  uint32_t false_relocalisations_refused;
  uint32_t budget_exceeded;
  uint32_t low_texture_frames;
  uint32_t mount_suspicions;  /**< frames in which mount or focal length seemed wrong */
  uint32_t ground_suspicions; /**< frames in which speed or camera height seemed wrong */
  uint32_t yaw_suspicions;    /**< frames in which odometry's yaw rate seemed wrong */
} cairn_health;

/** Takes the next `size` bytes of a map; false when it cannot. */
typedef bool (*cairn_write_bytes)(void* context, const uint8_t* bytes, size_t size);

/** Gives `size` bytes of a map from `offset` on; false when it cannot. The same offset must give
 * the same bytes during one load. */
typedef bool (*cairn_read_bytes)(void* context, uint32_t offset, uint8_t* bytes, size_t size);

#ifdef __cplusplus
}
#endif
