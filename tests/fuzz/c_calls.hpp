#pragma once

#include <cstddef>
#include <cstdint>

#include "cairn/cairn.h"

namespace cairn::fuzz {

// One name for the calls that the C interface has for each of its trackers.

inline cairn_status process(cairn_vehicle* t, const cairn_image* i, std::int64_t t_us,
                            cairn_report* report) {
  return cairn_vehicle_process_frame(t, i, t_us, report);
}
inline cairn_status process(cairn_handheld* t, const cairn_image* i, std::int64_t t_us,
                            cairn_report* report) {
  return cairn_handheld_process_frame(t, i, t_us, report);
}
inline cairn_status process(cairn_window* t, const cairn_image* i, std::int64_t t_us,
                            cairn_report* report) {
  return cairn_window_process_frame(t, i, t_us, report);
}

inline cairn_status set_work_limit(cairn_vehicle* t, std::int32_t units) {
  return cairn_vehicle_set_work_limit(t, units);
}
inline cairn_status set_work_limit(cairn_handheld* t, std::int32_t units) {
  return cairn_handheld_set_work_limit(t, units);
}
inline cairn_status set_work_limit(cairn_window* t, std::int32_t units) {
  return cairn_window_set_work_limit(t, units);
}

inline cairn_status set_ticks(cairn_vehicle* t, cairn_read_ticks read) {
  return cairn_vehicle_set_ticks(t, read, nullptr);
}
inline cairn_status set_ticks(cairn_handheld* t, cairn_read_ticks read) {
  return cairn_handheld_set_ticks(t, read, nullptr);
}
inline cairn_status set_ticks(cairn_window* t, cairn_read_ticks read) {
  return cairn_window_set_ticks(t, read, nullptr);
}

inline cairn_status get_landmarks(const cairn_vehicle* t, cairn_landmark* out, std::size_t capacity,
                                  std::size_t* count) {
  return cairn_vehicle_get_landmarks(t, out, capacity, count);
}
inline cairn_status get_landmarks(const cairn_handheld* t, cairn_landmark* out,
                                  std::size_t capacity, std::size_t* count) {
  return cairn_handheld_get_landmarks(t, out, capacity, count);
}
inline cairn_status get_landmarks(const cairn_window* t, cairn_landmark* out, std::size_t capacity,
                                  std::size_t* count) {
  return cairn_window_get_landmarks(t, out, capacity, count);
}

inline cairn_status get_health(const cairn_vehicle* t, cairn_health* health) {
  return cairn_vehicle_get_health(t, health);
}
inline cairn_status get_health(const cairn_handheld* t, cairn_health* health) {
  return cairn_handheld_get_health(t, health);
}
inline cairn_status get_health(const cairn_window* t, cairn_health* health) {
  return cairn_window_get_health(t, health);
}

inline std::uint64_t hash_of(const cairn_vehicle* t) {
  return cairn_vehicle_hash(t);
}
inline std::uint64_t hash_of(const cairn_handheld* t) {
  return cairn_handheld_hash(t);
}
inline std::uint64_t hash_of(const cairn_window* t) {
  return cairn_window_hash(t);
}

inline cairn_status draw(const cairn_vehicle* t, cairn_objects* objects, const cairn_canvas* canvas,
                         std::int32_t* drawn) {
  return cairn_vehicle_draw(t, objects, canvas, drawn);
}
inline cairn_status draw(const cairn_handheld* t, cairn_objects* objects,
                         const cairn_canvas* canvas, std::int32_t* drawn) {
  return cairn_handheld_draw(t, objects, canvas, drawn);
}
inline cairn_status draw(const cairn_window* t, cairn_objects* objects, const cairn_canvas* canvas,
                         std::int32_t* drawn) {
  return cairn_window_draw(t, objects, canvas, drawn);
}

inline cairn_status place_object(const cairn_vehicle* t, cairn_objects* objects, float x, float y) {
  return cairn_vehicle_place_object(t, objects, x, y);
}
inline cairn_status place_object(const cairn_handheld* t, cairn_objects* objects, float x,
                                 float y) {
  return x < 0.0F ? cairn_handheld_place_object(t, objects)
                  : cairn_handheld_place_object_at(t, objects, x, y);
}
inline cairn_status place_object(const cairn_window* t, cairn_objects* objects, float x, float y) {
  return x < 0.0F ? cairn_window_place_object(t, objects)
                  : cairn_window_place_object_at(t, objects, x, y);
}

inline cairn_status save_map(cairn_vehicle* t, std::uint8_t* to, std::size_t size,
                             std::size_t* used) {
  return cairn_vehicle_save_map(t, to, size, used);
}
inline cairn_status save_map(cairn_handheld* t, std::uint8_t* to, std::size_t size,
                             std::size_t* used) {
  return cairn_handheld_save_map(t, to, size, used);
}
inline cairn_status load_map(cairn_vehicle* t, const std::uint8_t* from, std::size_t size) {
  return cairn_vehicle_load_map(t, from, size);
}
inline cairn_status load_map(cairn_handheld* t, const std::uint8_t* from, std::size_t size) {
  return cairn_handheld_load_map(t, from, size);
}

}  // namespace cairn::fuzz
