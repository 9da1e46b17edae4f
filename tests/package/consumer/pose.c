#include <string.h>

#include "cairn/cairn.h"

static cairn_vehicle_memory memory;

int main(void) {
  const cairn_camera camera = {.fx = 500.0F,
                               .fy = 500.0F,
                               .cx = 319.5F,
                               .cy = 239.5F,
                               .width = CAIRN_MAX_IMAGE_WIDTH,
                               .height = CAIRN_MAX_IMAGE_HEIGHT};
  const cairn_transform T_vehicle_camera = {0.5F, -0.5F, 0.5F, -0.5F, 0.35F, 0.0F, 1.0F};
  const cairn_odometry still = {0, CAIRN_TWIST, 0.0F, 0.0F};
  cairn_vehicle* vehicle = NULL;
  if (strncmp(CAIRN_VERSION_STRING, "0.2.", 4) != 0) return 1;
  if (cairn_vehicle_initialise(memory.bytes, sizeof memory, &camera, &T_vehicle_camera, NULL, NULL,
                               &vehicle) != CAIRN_OK) {
    return 1;
  }
  return cairn_vehicle_add_odometry(vehicle, &still) == CAIRN_OK ? 0 : 1;
}
