#pragma once

/// Files of the development machine, for test firmware: by semihosting on emulated or debugged
/// boards, plainly on POSIX. Not part of what a board has to give.

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// Opens `path` for reading; a handle >= 0, or -1.
int32_t cairn_file_open(const char* path);

/// Bytes read into `buffer`, 0 at the end of the file, -1 on an error.
int32_t cairn_file_read(int32_t file, void* buffer, uint32_t size);

/// Length of the file in bytes, -1 on an error.
int32_t cairn_file_size(int32_t file);

/// Moves to `position` bytes from the start; 0, or -1 on an error.
int32_t cairn_file_seek(int32_t file, uint32_t position);

void cairn_file_close(int32_t file);

#ifdef __cplusplus
}
#endif
