/* Tracks and sends every pose. */

#include "board.h"
#include "pose_frame.h"

static cairn_vehicle_memory memory;

int main(void) {
  const cairn_camera camera = {
      .fx = 500.0F, .fy = 500.0F, .cx = 319.5F, .cy = 239.5F, .width = 640, .height = 480};
  const cairn_transform T_vehicle_camera = {0.48225F, -0.51715F, 0.51715F, -0.48225F,
                                            0.35F,    0.0F,      1.0F};
  cairn_vehicle* vehicle = NULL;
  const cairn_status status = cairn_vehicle_initialise(&memory, sizeof memory, &camera,
                                                       &T_vehicle_camera, NULL, NULL, &vehicle);
  if (status != CAIRN_OK) {
    board_print(cairn_status_text(status));
    return 1;
  }
  cairn_image image;
  int64_t t_us = 0;
  while (board_wait_for_frame(&image, &t_us)) {
    cairn_odometry sample;
    while (board_odometry_until(t_us, &sample)) (void)cairn_vehicle_add_odometry(vehicle, &sample);
    cairn_report report = {0};
    report.status = cairn_vehicle_process_frame(vehicle, &image, t_us, &report);
    if (report.t_us != t_us) continue; /* a frame that was refused has no pose */
    uint8_t bytes[POSE_FRAME_BYTES];
    board_send(bytes, pose_frame(&report, bytes));
  }
  return 0;
}
