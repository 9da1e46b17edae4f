#pragma once

/* Reads input logs (core/include/cairn/runtime/input_log.hpp) in C: what the C interface's tests
   are driven with. Damage is found by the C++ reader, which reads the same files. */

#include <stdbool.h>
#include <stdint.h>

#include "cairn/cairn.h"

struct log_header {
  bool handheld;
  bool window;
  bool ackermann;
  bool adaptive_fading;
  float fading;
  float focal_sigma;
  uint64_t seed;
  cairn_camera camera;
  cairn_transform T_vehicle_camera;
  float speed_sigma_mps, turn_sigma, wheelbase_m, odometry_period_s;
  cairn_vehicle_start start;
};

enum log_event { LOG_ODOMETRY, LOG_FRAME, LOG_END, LOG_DAMAGED };

struct log_frame {
  uint32_t number;
  int64_t t_us;
  int32_t work_limit; /* -1: the tracker's own */
};

/* False unless the file begins with a log's header. */
bool log_open(const char* path, int32_t* file, struct log_header* header);

/* The next event; a frame's pixels go to `pixels`, which has room for `capacity`. */
enum log_event log_next(int32_t file, cairn_odometry* sample, struct log_frame* frame,
                        uint8_t* pixels, uint32_t capacity);
