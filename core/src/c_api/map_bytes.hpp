#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "cairn/c_api/types.h"
#include "cairn/map/map_file.hpp"

namespace cairn::c_api {

/// Bytes of a full map of a configuration's library.
template <class Library>
constexpr std::size_t map_bytes(int landmarks) {
  return static_cast<std::size_t>(kMapHeaderBytes + kMapTrailerBytes) +
         static_cast<std::size_t>(landmarks) *
             static_cast<std::size_t>(detail::landmark_bytes<Library::kViews>());
}

/// A C program's function as a sink of the core.
struct CallerSink {
  cairn_write_bytes write;
  void* context;

  static bool take(void* self, const std::uint8_t* bytes, int count) {
    const CallerSink& sink = *static_cast<const CallerSink*>(self);
    return sink.write(sink.context, bytes, static_cast<std::size_t>(count));
  }
};

/// A C program's function as a source of the core.
struct CallerSource {
  cairn_read_bytes read;
  void* context;

  static bool give(void* self, std::uint32_t offset, std::uint8_t* bytes, int count) {
    const CallerSource& source = *static_cast<const CallerSource*>(self);
    return source.read(source.context, offset, bytes, static_cast<std::size_t>(count));
  }
};

/// A buffer that is filled from its start.
struct Buffer {
  std::uint8_t* bytes;
  std::size_t size;
  std::size_t used;

  static bool take(void* self, const std::uint8_t* bytes, std::size_t count) {
    Buffer& buffer = *static_cast<Buffer*>(self);
    if (count > buffer.size - buffer.used) return false;
    std::memcpy(buffer.bytes + buffer.used, bytes, count);
    buffer.used += count;
    return true;
  }
};

struct Bytes {
  const std::uint8_t* bytes;
  std::size_t size;

  static bool give(void* self, std::uint32_t offset, std::uint8_t* bytes, std::size_t count) {
    const Bytes& source = *static_cast<const Bytes*>(self);
    if (offset > source.size || count > source.size - offset) return false;
    std::memcpy(bytes, source.bytes + offset, count);
    return true;
  }
};

}  // namespace cairn::c_api
