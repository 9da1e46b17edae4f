#pragma once

#include <cstdint>
#include <limits>

#include "cairn/base/ticks.hpp"
#include "cairn/map/map_file.hpp"
#include "cairn/runtime/augmentation.hpp"
#include "cairn/runtime/replay.hpp"

#include "convert.hpp"
#include "health.hpp"
#include "map_bytes.hpp"
#include "objects.hpp"

namespace cairn::c_api {

// What both trackers' objects do alike. `Object` has `tracker`, `report` (of the last accepted
// frame), `ticks` and `accepted` (whether there was one).

template <class Object>
cairn_status process_frame(Object& object, const cairn_image& image, std::int64_t t_us,
                           cairn_report* report) {
  const std::int64_t untouched = t_us == 0 ? 1 : 0;
  FrameReport own;
  own.t_us = untouched;
  const Status status = object.tracker.process_frame(from_c(image), t_us, object.ticks, own);
  // A frame that is refused leaves the report as it was.
  if (own.t_us == untouched) return to_c(status);
  own.status = status;
  object.report = own;
  object.accepted = true;
  if (report != nullptr) *report = to_c(own);
  return to_c(status);
}

template <class Object>
std::uint64_t hash_of(const Object& object) {
  return frame_hash(object.tracker, object.report);
}

template <class Object>
cairn_status draw(const Object& object, cairn_objects& objects, const cairn_canvas& canvas,
                  std::int32_t* drawn) {
  if (drawn != nullptr) *drawn = 0;
  if (!object.accepted) return CAIRN_NOT_INITIALISED;
  const PinholeCamera<float> camera = drawing_camera(object.tracker);
  const MutableImageView view = from_c(canvas, camera);
  if (view.data == nullptr) return CAIRN_INVALID_ARGUMENT;
  if (object.tracker.state() == TrackingState::kLost) return CAIRN_OK;
  const int count = objects.augmenter.draw(camera, object.report.T_map_camera, view);
  if (drawn != nullptr) *drawn = count;
  return CAIRN_OK;
}

template <class Object>
cairn_status write_map(Object& object, cairn_write_bytes write, void* context) {
  CallerSink sink{write, context};
  return to_c(object.tracker.save_map(ByteSink{&CallerSink::take, &sink}));
}

template <class Object>
cairn_status save_map(Object& object, std::uint8_t* bytes, std::size_t size, std::size_t& used) {
  Buffer buffer{bytes, size, 0};
  const cairn_status status = write_map(object, &Buffer::take, &buffer);
  used = buffer.used;
  return status;
}

template <class Object>
cairn_status read_map(Object& object, cairn_read_bytes read, void* context, std::uint32_t size) {
  CallerSource source{read, context};
  MapFileInfo info;
  return to_c(object.tracker.load_map(ByteSource{&CallerSource::give, &source, size}, info));
}

template <class Object>
cairn_status load_map(Object& object, const std::uint8_t* bytes, std::size_t size) {
  if (size > std::numeric_limits<std::uint32_t>::max()) return CAIRN_INVALID_ARGUMENT;
  Bytes source{bytes, size};
  return read_map(object, &Bytes::give, &source, static_cast<std::uint32_t>(size));
}

}  // namespace cairn::c_api
