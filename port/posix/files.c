#define _POSIX_C_SOURCE 200809L

#include "cairn/port/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

int32_t cairn_file_open(const char* path) {
  return open(path, O_RDONLY);
}

int32_t cairn_file_read(int32_t file, void* buffer, uint32_t size) {
  uint32_t done = 0;
  while (done < size) {
    const ssize_t got = read(file, (char*)buffer + done, size - done);
    if (got < 0) return -1;
    if (got == 0) break;
    done += (uint32_t)got;
  }
  return (int32_t)done;
}

int32_t cairn_file_size(int32_t file) {
  struct stat status;
  if (fstat(file, &status) != 0 || status.st_size > INT32_MAX) return -1;
  return (int32_t)status.st_size;
}

int32_t cairn_file_seek(int32_t file, uint32_t position) {
  return lseek(file, (off_t)position, SEEK_SET) < 0 ? -1 : 0;
}

void cairn_file_close(int32_t file) {
  close(file);
}
