#pragma once

/* What the examples ask of a board: its camera, its odometry, and a place for messages. log_board.c
   plays a recording on a PC; boards/ has sketches for real ones. */

#include <stdbool.h>
#include <stdint.h>

#include "cairn/cairn.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Waits for the next frame, which stays until the next call; false when there is none any more. */
bool board_wait_for_frame(cairn_image* image, int64_t* t_us);

/* The next odometry sample up to a time; false when there is none. */
bool board_odometry_until(int64_t t_us, cairn_odometry* sample);

/* One line of text. */
void board_print(const char* text);

/* Sends bytes, by UART or to a file. */
void board_send(const uint8_t* bytes, size_t count);

#ifdef __cplusplus
}
#endif
