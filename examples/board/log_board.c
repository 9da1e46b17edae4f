/* A board on a PC: plays the input log that the environment variable CAIRN_LOG names
   (cairn_sim run hall --record hall.log). board_send() writes to the file of CAIRN_SENT. */

#include <stdio.h>
#include <stdlib.h>

#include "board.h"
#include "log_file.h"

enum { kQueue = 64 };

static uint8_t pixels[CAIRN_MAX_IMAGE_WIDTH * CAIRN_MAX_IMAGE_HEIGHT];
static struct log_header header;
static int32_t file = -1;
static cairn_odometry samples[kQueue];
static int first, count;

static void need(bool good, const char* what) {
  if (good) return;
  fprintf(stderr, "log_board: %s\n", what);
  exit(2);
}

bool board_wait_for_frame(cairn_image* image, int64_t* t_us) {
  if (file < 0) {
    const char* path = getenv("CAIRN_LOG");
    need(path != NULL, "CAIRN_LOG names no input log");
    need(log_open(path, &file, &header), "CAIRN_LOG is no input log");
  }
  for (;;) {
    cairn_odometry sample;
    struct log_frame frame;
    switch (log_next(file, &sample, &frame, pixels, sizeof pixels)) {
      case LOG_ODOMETRY:
        need(count < kQueue, "more odometry between two frames than the queue holds");
        samples[(first + count++) % kQueue] = sample;
        break;
      case LOG_FRAME:
        *image =
            (cairn_image){pixels, header.camera.width, header.camera.height, header.camera.width};
        *t_us = frame.t_us;
        return true;
      case LOG_END:
        return false;
      default:
        need(false, "CAIRN_LOG is damaged");
    }
  }
}

bool board_odometry_until(int64_t t_us, cairn_odometry* sample) {
  if (count == 0 || samples[first].t_us > t_us) return false;
  *sample = samples[first];
  first = (first + 1) % kQueue;
  --count;
  return true;
}

void board_print(const char* text) {
  puts(text);
}

void board_send(const uint8_t* bytes, size_t size) {
  static FILE* sent;
  if (sent == NULL) {
    const char* path = getenv("CAIRN_SENT");
    need(path != NULL && (sent = fopen(path, "wb")) != NULL, "CAIRN_SENT names no file to write");
  }
  need(fwrite(bytes, 1, size, sent) == size && fflush(sent) == 0, "CAIRN_SENT cannot be written");
}
