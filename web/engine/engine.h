#pragma once

/** @file
 * What the page calls: the C interface for one drive or one camera at a time. All memory is static,
 * the clip apart. Calls that return int32_t give a cairn_status, or what they say. */

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { WEB_STAGES = 5, WEB_MOST_POINTS = 64, WEB_FRAME = 1, WEB_END = 0, WEB_DAMAGED = -1 };

/** What the last frame gave. Read by page/engine.js in this order: a change here is one there. */
struct web_result {
  uint32_t frame_hash[2];   /**< low word first: of pose, covariance, landmarks and counters */
  uint32_t picture_hash[2]; /**< of the drive's picture with the objects drawn into it */
  uint32_t number;
  int32_t status, state; /**< cairn_status, cairn_state */
  int32_t width, height;
  int32_t stage_us[WEB_STAGES]; /**< by the page's clock */
  int32_t searched, matches, inliers, landmarks, work;
  int32_t placed, drawn; /**< objects in the map, and of these in the picture */
  int32_t points;        /**< landmarks in the picture */
  float point_px[2 * WEB_MOST_POINTS];
  double t_us;
};

/** Memory for a clip of so many bytes; what it held before is lost. NULL: no memory. */
uint8_t* web_reserve_clip(uint32_t bytes);
/** Starts the drive of the reserved clip anew. CAIRN_CORRUPT, CAIRN_VERSION_MISMATCH. */
int32_t web_start_drive(void);
/** Tracks the drive's next frame: WEB_FRAME, WEB_END after the last, WEB_DAMAGED. */
int32_t web_next_frame(void);

/** Starts hand-held tracking of pictures of a size, whose longer side has the field of view
 * `fov_rad` and whose lens bends no lines. CAIRN_BAD_CONFIG. */
int32_t web_start_camera(int32_t width, int32_t height, float fov_rad);
/** Where a camera's picture goes: width * height of red, green, blue, opacity. */
uint8_t* web_camera_picture(void);
/** Tracks that picture, taken at a time. */
int32_t web_track_camera(double t_us);
/** Puts an object where the ray of a pixel meets the scene. CAIRN_NOT_FOUND: too little is known of
 * it yet. CAIRN_FULL. */
int32_t web_place(float x_px, float y_px);

const struct web_result* web_last_result(void);
/** The drive's frame, or nothing (opacity 0) over a camera's picture, with the objects: width *
 * height of red, green, blue, opacity. */
const uint8_t* web_shown_picture(void);
const char* web_status_text(int32_t status);

#ifdef __cplusplus
}
#endif
