/* NEVER RUN ON HARDWARE. ESP32-S3 with PSRAM: grey frames of 320x240 by esp32-camera, hand-held
   mode.

   Use it as app_main() of an ESP-IDF project with the components cairn and esp32-camera, and link
   cairn with CAIRN_CONFIG_TINY, which fits frames of this size: its tracker lies in internal RAM.
   The pins are those of the ESP32-S3-EYE. */

#include <stdio.h>

#include "cairn/cairn.h"

#include "esp_camera.h"

enum { kWidth = 320, kHeight = 240 };

static cairn_handheld_memory memory;

static int start_camera(void) {
  const camera_config_t config = {.pin_pwdn = -1,
                                  .pin_reset = -1,
                                  .pin_xclk = 15,
                                  .pin_sccb_sda = 4,
                                  .pin_sccb_scl = 5,
                                  .pin_d7 = 16,
                                  .pin_d6 = 17,
                                  .pin_d5 = 18,
                                  .pin_d4 = 12,
                                  .pin_d3 = 10,
                                  .pin_d2 = 8,
                                  .pin_d1 = 9,
                                  .pin_d0 = 11,
                                  .pin_vsync = 6,
                                  .pin_href = 7,
                                  .pin_pclk = 13,
                                  .xclk_freq_hz = 20000000,
                                  .pixel_format = PIXFORMAT_GRAYSCALE,
                                  .frame_size = FRAMESIZE_QVGA,
                                  .fb_count = 2,
                                  .fb_location = CAMERA_FB_IN_PSRAM,
                                  .grab_mode = CAMERA_GRAB_LATEST};
  return esp_camera_init(&config);
}

static void track(cairn_handheld* handheld, const camera_fb_t* frame) {
  const cairn_image image = {frame->buf, (int32_t)frame->width, (int32_t)frame->height,
                             (int32_t)frame->width};
  const int64_t t_us = (int64_t)frame->timestamp.tv_sec * 1000000 + frame->timestamp.tv_usec;
  cairn_report report = {0};
  const cairn_status status = cairn_handheld_process_frame(handheld, &image, t_us, &report);
  const cairn_transform* T = &report.T_map_camera;
  printf("%s %d %.3f %.3f %.3f\n", cairn_status_text(status), (int)report.state, (double)T->x,
         (double)T->y, (double)T->z);
}

void app_main(void) {
  const cairn_camera camera = {.fx = 300.0F, /* of your calibration */
                               .fy = 300.0F,
                               .cx = 159.5F,
                               .cy = 119.5F,
                               .width = kWidth,
                               .height = kHeight};
  cairn_handheld* handheld = NULL;
  const cairn_status status =
      cairn_handheld_initialise(&memory, sizeof memory, &camera, NULL, &handheld);
  if (status != CAIRN_OK || start_camera() != 0) {
    printf("start: %s, or the camera's\n", cairn_status_text(status));
    return;
  }
  for (;;) {
    camera_fb_t* const frame = esp_camera_fb_get();
    if (frame == NULL) continue;
    track(handheld, frame);
    esp_camera_fb_return(frame);
  }
}
