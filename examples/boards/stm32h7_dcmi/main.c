/* NEVER RUN ON HARDWARE. STM32H743: grey frames of 640x480 from DCMI by DMA, tracked on a vehicle.

   Clocks, SDRAM, DCMI, I2C of the sensor and the UART are set up by CubeMX (names as it writes
   them); the sensor sends 8-bit grey, or its Y channel. Read encoder_speed_mps() and
   gyro_yaw_rate_radps() from your own drivers. */

#include "cairn/cairn.h"

#include "double_buffer.h"
#include "stm32h7xx_hal.h"

enum { kWidth = 640, kHeight = 480, kOdometryPeriod_us = 20000 };

/* DTCM has 128 KB and AXI SRAM 512 KB: the tracker goes to AXI SRAM, the frames to SDRAM. */
__attribute__((section(".bss.axi_sram"))) static cairn_vehicle_memory memory;
__attribute__((section(".bss.sdram"),
               aligned(CACHE_LINE_BYTES))) static uint8_t frames[2][kWidth * kHeight];

extern DCMI_HandleTypeDef hdcmi;
extern int64_t microseconds(void); /* of a 64-bit timer; never jumps back */
extern float encoder_speed_mps(void);
extern float gyro_yaw_rate_radps(void);
extern void show_pose(const cairn_report* report);

static struct double_buffer buffers;
static volatile int filling;

static void invalidate(void* at, uint32_t bytes) {
  SCB_InvalidateDCache_by_Addr(at, (int32_t)bytes);
}

static void start_frame(void) {
  (void)HAL_DCMI_Start_DMA(&hdcmi, DCMI_MODE_SNAPSHOT, (uint32_t)(uintptr_t)buffers.frames[filling],
                           kWidth * kHeight / 4);
}

/* At the end of a frame. The middle of the exposure was half a frame and half the exposure ago. */
void HAL_DCMI_FrameEventCallback(DCMI_HandleTypeDef* dcmi) {
  (void)dcmi;
  const int64_t exposure_middle_ago_us = 16000 + 5000;
  filling = double_buffer_filled(&buffers, filling, microseconds() - exposure_middle_ago_us);
  start_frame();
}

static void add_odometry(cairn_vehicle* vehicle, int64_t* next_us) {
  const int64_t now_us = microseconds();
  if (now_us < *next_us) return;
  *next_us = now_us + kOdometryPeriod_us;
  const cairn_odometry sample = {now_us, CAIRN_TWIST, encoder_speed_mps(), gyro_yaw_rate_radps()};
  (void)cairn_vehicle_add_odometry(vehicle, &sample);
}

static void track(cairn_vehicle* vehicle) {
  cairn_image image;
  int64_t t_us = 0;
  __disable_irq();
  const bool taken = double_buffer_take(&buffers, &image, &t_us);
  __enable_irq();
  if (!taken) return;
  cairn_report report = {0};
  (void)cairn_vehicle_process_frame(vehicle, &image, t_us, &report);
  double_buffer_release(&buffers);
  show_pose(&report);
}

/* Call it from main() after CubeMX's set-up. */
int run_cairn(void) {
  const cairn_camera camera = {.fx = 500.0F, /* of your calibration */
                               .fy = 500.0F,
                               .cx = 319.5F,
                               .cy = 239.5F,
                               .width = kWidth,
                               .height = kHeight};
  const cairn_transform T_vehicle_camera = {0.5F, -0.5F, 0.5F, -0.5F, 0.35F, 0.0F, 1.0F};
  cairn_vehicle_start start = {0};
  start.t_us = microseconds();
  cairn_vehicle_parameters parameters = cairn_vehicle_default_parameters();
  parameters.sample_period_s = (float)kOdometryPeriod_us * 1e-6F;
  cairn_vehicle* vehicle = NULL;
  const cairn_status status = cairn_vehicle_initialise(
      &memory, sizeof memory, &camera, &T_vehicle_camera, &start, &parameters, &vehicle);
  if (status != CAIRN_OK ||
      !double_buffer_init(&buffers, frames[0], frames[1], kWidth, kHeight, invalidate)) {
    return (int)status;
  }
  start_frame();
  int64_t next_odometry_us = 0;
  for (;;) {
    add_odometry(vehicle, &next_odometry_us);
    track(vehicle);
    __WFI();
  }
}
