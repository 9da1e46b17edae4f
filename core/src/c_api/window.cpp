#include "cairn/c_api/window.h"

#include <new>

#include "cairn/runtime/window_augmentation.hpp"

#include "tracker_calls.hpp"
#include "window_object.hpp"

static_assert(static_cast<int>(cairn::GyroTrust::kAgrees) == CAIRN_GYRO_AGREES, "");
static_assert(static_cast<int>(cairn::GyroTrust::kContradicted) == CAIRN_GYRO_CONTRADICTED, "");

namespace {

using cairn::Status;
using cairn::c_api::from_c;
using cairn::c_api::to_c;

using Tracker = cairn::c_api::Window;

Tracker::Parameters parameters_from(const cairn_window_parameters& from) {
  Tracker::Parameters to;
  to.sigma_px = from.sigma_px;
  to.window.focal_sigma = from.focal_sigma;
  to.work_limit = from.work_limit;
  to.max_step_us = from.max_step_us;
  to.seed = from.seed;
  to.gyro.R_camera_gyro =
      cairn::Quaternion<float>(from.gyro.qw, from.gyro.qx, from.gyro.qy, from.gyro.qz);
  to.gyro.noise_density = from.gyro.noise_density;
  to.gyro.bias_sigma_radps = from.gyro.bias_sigma_radps;
  to.gyro.bias_walk = from.gyro.bias_walk;
  to.gyro.time_sigma_s = from.gyro.time_sigma_s;
  to.gyro.range_radps = from.gyro.range_radps;
  to.readout.row_time_s = from.row_time_s;
  to.readout.column_time_s = from.column_time_s;
  return to;
}

}  // namespace

cairn_window_parameters cairn_window_default_parameters(void) {
  const Tracker::Parameters from;
  const cairn::GyroParameters& gyro = from.gyro;
  const cairn::Quaternion<float>& q = gyro.R_camera_gyro;
  return {from.sigma_px,
          from.window.focal_sigma,
          from.work_limit,
          from.max_step_us,
          from.seed,
          {q.w(), q.x(), q.y(), q.z(), gyro.noise_density, gyro.bias_sigma_radps, gyro.bias_walk,
           gyro.time_sigma_s, gyro.range_radps},
          from.readout.row_time_s,
          from.readout.column_time_s};
}

cairn_status cairn_window_initialise(void* memory, size_t bytes, const cairn_camera* camera,
                                     const cairn_window_parameters* parameters,
                                     cairn_window** window) {
  if (window == nullptr) return CAIRN_INVALID_ARGUMENT;
  *window = nullptr;
  if (camera == nullptr || !cairn::c_api::fits(memory, bytes, sizeof(cairn_window))) {
    return CAIRN_INVALID_ARGUMENT;
  }
  auto* const made = new (memory) cairn_window;
  made->parameters = parameters != nullptr ? *parameters : cairn_window_default_parameters();
  const Status status =
      made->tracker.initialise(from_c(*camera), parameters_from(made->parameters));
  if (ok(status)) *window = made;
  return to_c(status);
}

cairn_status cairn_window_reset(cairn_window* window) {
  if (window == nullptr) return CAIRN_INVALID_ARGUMENT;
  const cairn::PinholeCamera<float> camera = window->tracker.told_camera();
  const Status status = window->tracker.initialise(camera, parameters_from(window->parameters));
  if (!ok(status)) return to_c(status);
  window->report = cairn::FrameReport();
  window->accepted = false;
  return CAIRN_OK;
}

cairn_status cairn_window_add_angular_rate(cairn_window* window, const cairn_angular_rate* sample) {
  if (window == nullptr || sample == nullptr) return CAIRN_INVALID_ARGUMENT;
  return to_c(window->tracker.add_angular_rate(
      {sample->t_us, {sample->x_radps, sample->y_radps, sample->z_radps}}));
}

cairn_status cairn_window_get_gyro(const cairn_window* window, cairn_gyro* gyro) {
  if (window == nullptr || gyro == nullptr) return CAIRN_INVALID_ARGUMENT;
  const cairn::GyroReport own = window->tracker.gyro().report();
  *gyro = {static_cast<cairn_gyro_trust>(own.trust),
           own.difference,
           own.bias_radps.x(),
           own.bias_radps.y(),
           own.bias_radps.z(),
           own.bias_sigma_radps,
           own.time_offset_s,
           own.time_offset_sigma_s,
           own.samples,
           own.refused,
           own.saturated,
           own.gaps};
  return CAIRN_OK;
}

cairn_status cairn_window_process_frame(cairn_window* window, const cairn_image* image,
                                        int64_t t_us, cairn_report* report) {
  if (window == nullptr || image == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::process_frame(*window, *image, t_us, report);
}

cairn_status cairn_window_set_work_limit(cairn_window* window, int32_t units) {
  if (window == nullptr) return CAIRN_INVALID_ARGUMENT;
  return to_c(window->tracker.set_work_limit(units));
}

cairn_status cairn_window_set_ticks(cairn_window* window, cairn_read_ticks read, void* context) {
  if (window == nullptr) return CAIRN_INVALID_ARGUMENT;
  window->ticks = {read, context};
  return CAIRN_OK;
}

cairn_status cairn_window_get_covariance(const cairn_window* window, float covariance[36]) {
  if (window == nullptr || covariance == nullptr) return CAIRN_INVALID_ARGUMENT;
  // The tracker's translation is in the axes of the camera, the interface's in those of the map.
  cairn::Matrix<float, 6, 6> to_interface = cairn::Matrix<float, 6, 6>::Identity();
  to_interface.topLeftCorner<3, 3>() = window->tracker.T_world_camera().rotation.toRotationMatrix();
  const cairn::Matrix<float, 6, 6> own =
      to_interface * window->tracker.pose_covariance() * to_interface.transpose();
  for (int i = 0; i < 36; ++i) covariance[i] = own(i / 6, i % 6);
  return CAIRN_OK;
}

cairn_status cairn_window_get_focal_scale(const cairn_window* window, float* scale, float* sigma) {
  if (window == nullptr || scale == nullptr || sigma == nullptr) return CAIRN_INVALID_ARGUMENT;
  const cairn::FocalScale focal = window->tracker.focal_scale();
  *scale = focal.value;
  *sigma = focal.sigma;
  return CAIRN_OK;
}

cairn_status cairn_window_get_landmarks(const cairn_window* window, cairn_landmark* landmarks,
                                        size_t capacity, size_t* count) {
  if (window == nullptr || count == nullptr || (landmarks == nullptr && capacity != 0)) {
    return CAIRN_INVALID_ARGUMENT;
  }
  const Tracker& tracker = window->tracker;
  *count = 0;
  for (int i = 0; i < tracker.feature_count() && *count < capacity; ++i) {
    cairn::Vector3<float> position;
    cairn::Matrix3<float> covariance;
    if (!ok(tracker.feature_position(i, position, covariance))) continue;
    landmarks[(*count)++] =
        to_c(tracker.feature_id(i), position, covariance, cairn::Rigid<float>());
  }
  return CAIRN_OK;
}

cairn_status cairn_window_get_health(const cairn_window* window, cairn_health* health) {
  if (window == nullptr || health == nullptr) return CAIRN_INVALID_ARGUMENT;
  cairn::c_api::copy_health(window->tracker.health(), *health);
  return CAIRN_OK;
}

uint64_t cairn_window_hash(const cairn_window* window) {
  return window != nullptr ? cairn::c_api::hash_of(*window) : 0;
}

cairn_status cairn_window_place_object(const cairn_window* window, cairn_objects* objects) {
  if (window == nullptr || objects == nullptr) return CAIRN_INVALID_ARGUMENT;
  cairn::ObjectPlacement placement{cairn::Vector3<float>::Zero(), cairn::Random(1)};
  cairn::Rigid<float> T_map_object;
  if (!find_object_place(window->tracker, placement, T_map_object)) return CAIRN_NOT_FOUND;
  return to_c(objects->augmenter.place(T_map_object));
}

cairn_status cairn_window_place_object_at(const cairn_window* window, cairn_objects* objects,
                                          float x_px, float y_px) {
  if (window == nullptr || objects == nullptr) return CAIRN_INVALID_ARGUMENT;
  const cairn::Vector2<float> pixel(x_px, y_px);
  if (!window->tracker.camera().contains(pixel)) return CAIRN_INVALID_ARGUMENT;
  cairn::Random random(1);
  cairn::Rigid<float> T_map_object;
  if (!cairn::place_at_pixel(window->tracker, pixel, random, T_map_object)) return CAIRN_NOT_FOUND;
  return to_c(objects->augmenter.place(T_map_object));
}

cairn_status cairn_window_draw(const cairn_window* window, cairn_objects* objects,
                               const cairn_canvas* canvas, int32_t* drawn) {
  if (window == nullptr || objects == nullptr || canvas == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::draw(*window, *objects, *canvas, drawn);
}
