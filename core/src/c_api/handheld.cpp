#include "cairn/c_api/handheld.h"

#include <new>

#include "handheld_object.hpp"
#include "tracker_calls.hpp"

namespace {

using cairn::Rigid;
using cairn::Status;
using cairn::c_api::from_c;
using cairn::c_api::to_c;

using Tracker = cairn::c_api::Handheld;

Tracker::Parameters parameters_from(const cairn_handheld_parameters& from) {
  Tracker::Parameters to;
  to.filter.sigma_px = from.sigma_px;
  to.motion.least_velocity_noise = from.least_velocity_noise;
  to.motion.most_velocity_noise = from.most_velocity_noise;
  to.motion.least_rate_noise = from.least_rate_noise;
  to.motion.most_rate_noise = from.most_rate_noise;
  to.filter.fading_factor = from.fading_factor;
  to.filter.fading =
      from.adaptive_fading ? cairn::FadingMode::kAdaptive : cairn::FadingMode::kFixed;
  to.filter.estimate_focal_length = from.estimate_focal_length;
  to.work_limit = from.work_limit;
  to.max_step_us = from.max_step_us;
  to.seed = from.seed;
  return to;
}

}  // namespace

cairn_handheld_parameters cairn_handheld_default_parameters(void) {
  const Tracker::Parameters from;
  return {from.filter.sigma_px,
          from.motion.least_velocity_noise,
          from.motion.most_velocity_noise,
          from.motion.least_rate_noise,
          from.motion.most_rate_noise,
          from.filter.fading_factor,
          from.filter.fading == cairn::FadingMode::kAdaptive,
          from.filter.estimate_focal_length,
          from.work_limit,
          from.max_step_us,
          from.seed};
}

cairn_status cairn_handheld_initialise(void* memory, size_t bytes, const cairn_camera* camera,
                                       const cairn_handheld_parameters* parameters,
                                       cairn_handheld** handheld) {
  if (handheld == nullptr) return CAIRN_INVALID_ARGUMENT;
  *handheld = nullptr;
  if (camera == nullptr || !cairn::c_api::fits(memory, bytes, sizeof(cairn_handheld))) {
    return CAIRN_INVALID_ARGUMENT;
  }
  auto* const made = new (memory) cairn_handheld;
  made->parameters = parameters != nullptr ? *parameters : cairn_handheld_default_parameters();
  const Status status =
      made->tracker.initialise(from_c(*camera), parameters_from(made->parameters));
  if (ok(status)) *handheld = made;
  return to_c(status);
}

cairn_status cairn_handheld_reset(cairn_handheld* handheld) {
  if (handheld == nullptr) return CAIRN_INVALID_ARGUMENT;
  const cairn::PinholeCamera<float> camera = handheld->tracker.camera();
  const Status status = handheld->tracker.initialise(camera, parameters_from(handheld->parameters));
  if (!ok(status)) return to_c(status);
  handheld->report = cairn::FrameReport();
  handheld->accepted = false;
  return CAIRN_OK;
}

cairn_status cairn_handheld_process_frame(cairn_handheld* handheld, const cairn_image* image,
                                          int64_t t_us, cairn_report* report) {
  if (handheld == nullptr || image == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::process_frame(*handheld, *image, t_us, report);
}

cairn_status cairn_handheld_set_work_limit(cairn_handheld* handheld, int32_t units) {
  if (handheld == nullptr) return CAIRN_INVALID_ARGUMENT;
  return to_c(handheld->tracker.set_work_limit(units));
}

cairn_status cairn_handheld_set_ticks(cairn_handheld* handheld, cairn_read_ticks read,
                                      void* context) {
  if (handheld == nullptr) return CAIRN_INVALID_ARGUMENT;
  handheld->ticks = {read, context};
  return CAIRN_OK;
}

cairn_status cairn_handheld_get_covariance(const cairn_handheld* handheld, float covariance[36]) {
  if (handheld == nullptr || covariance == nullptr) return CAIRN_INVALID_ARGUMENT;
  const cairn::Matrix<float, 6, 6> own = handheld->tracker.filter().pose_covariance();
  for (int i = 0; i < 36; ++i) covariance[i] = own(i / 6, i % 6);
  return CAIRN_OK;
}

cairn_status cairn_handheld_get_landmarks(const cairn_handheld* handheld, cairn_landmark* landmarks,
                                          size_t capacity, size_t* count) {
  if (handheld == nullptr || count == nullptr || (landmarks == nullptr && capacity != 0)) {
    return CAIRN_INVALID_ARGUMENT;
  }
  const Tracker::Filter& filter = handheld->tracker.filter();
  *count = 0;
  for (int slot = 0; slot < filter.feature_count() && *count < capacity; ++slot) {
    cairn::Vector3<float> position;
    cairn::Matrix3<float> covariance;
    if (!ok(filter.feature_position(slot, position, covariance))) continue;
    landmarks[(*count)++] =
        to_c(filter.feature_id(slot), position, covariance, cairn::Rigid<float>());
  }
  return CAIRN_OK;
}

cairn_status cairn_handheld_get_health(const cairn_handheld* handheld, cairn_health* health) {
  if (handheld == nullptr || health == nullptr) return CAIRN_INVALID_ARGUMENT;
  cairn::c_api::copy_health(handheld->tracker.health(), *health);
  return CAIRN_OK;
}

uint64_t cairn_handheld_hash(const cairn_handheld* handheld) {
  return handheld != nullptr ? cairn::c_api::hash_of(*handheld) : 0;
}

cairn_status cairn_handheld_place_object(const cairn_handheld* handheld, cairn_objects* objects) {
  if (handheld == nullptr || objects == nullptr) return CAIRN_INVALID_ARGUMENT;
  cairn::ObjectPlacement placement{cairn::Vector3<float>::Zero(), cairn::Random(1)};
  cairn::Rigid<float> T_map_object;
  if (!find_object_place(handheld->tracker, placement, T_map_object)) return CAIRN_NOT_FOUND;
  return to_c(objects->augmenter.place(T_map_object));
}

cairn_status cairn_handheld_place_object_at(const cairn_handheld* handheld, cairn_objects* objects,
                                            float x_px, float y_px) {
  if (handheld == nullptr || objects == nullptr) return CAIRN_INVALID_ARGUMENT;
  const Tracker::Filter& filter = handheld->tracker.filter();
  const cairn::Vector2<float> pixel(x_px, y_px);
  if (!filter.camera().contains(pixel)) return CAIRN_INVALID_ARGUMENT;
  cairn::Random random(1);
  Rigid<float> T_map_object;
  if (!cairn::place_at_pixel(filter, pixel, random, T_map_object)) return CAIRN_NOT_FOUND;
  return to_c(objects->augmenter.place(T_map_object));
}

cairn_status cairn_handheld_draw(const cairn_handheld* handheld, cairn_objects* objects,
                                 const cairn_canvas* canvas, int32_t* drawn) {
  if (handheld == nullptr || objects == nullptr || canvas == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::draw(*handheld, *objects, *canvas, drawn);
}

cairn_status cairn_handheld_save_map(cairn_handheld* handheld, uint8_t* buffer, size_t size,
                                     size_t* used) {
  if (handheld == nullptr || buffer == nullptr || used == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::save_map(*handheld, buffer, size, *used);
}

cairn_status cairn_handheld_load_map(cairn_handheld* handheld, const uint8_t* bytes, size_t size) {
  if (handheld == nullptr || bytes == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::load_map(*handheld, bytes, size);
}

cairn_status cairn_handheld_write_map(cairn_handheld* handheld, cairn_write_bytes write,
                                      void* context) {
  if (handheld == nullptr || write == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::write_map(*handheld, write, context);
}

cairn_status cairn_handheld_read_map(cairn_handheld* handheld, cairn_read_bytes read, void* context,
                                     uint32_t size) {
  if (handheld == nullptr || read == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::read_map(*handheld, read, context, size);
}
