#include "cairn/c_api/vehicle.h"

#include <new>

#include "tracker_calls.hpp"
#include "vehicle_object.hpp"

namespace {

using cairn::Rigid;
using cairn::Status;
using cairn::c_api::from_c;
using cairn::c_api::to_c;

using Filter = cairn::c_api::VehicleFilter;
using Tracker = cairn::c_api::Vehicle;

Tracker::Parameters parameters_from(const cairn_vehicle_parameters& from) {
  Tracker::Parameters to;
  to.odometry.sigma_speed_mps = from.sigma_speed_mps;
  to.odometry.sigma_turn = from.sigma_turn;
  to.odometry.wheelbase_m = from.wheelbase_m;
  to.odometry.sample_period_s = from.sample_period_s;
  to.sigma_px = from.sigma_px;
  to.floor.sigma_m = from.floor_sigma_m;
  to.filter.tilt.sigma_pitch_rad = from.sigma_pitch_rad;
  to.filter.tilt.sigma_roll_rad = from.sigma_roll_rad;
  to.filter.tilt.time_constant_s = from.tilt_time_constant_s;
  to.work_limit = from.work_limit;
  to.max_step_us = from.max_step_us;
  to.seed = from.seed;
  return to;
}

Tracker::Start start_from(const cairn_vehicle_start* from) {
  Tracker::Start to;
  if (from == nullptr) return to;
  to.t_us = from->t_us;
  to.pose.position = cairn::Vector2<float>(from->x_m, from->y_m);
  to.pose.heading = from->heading_rad;
  to.covariance(0, 0) = from->position_variance;
  to.covariance(1, 1) = from->position_variance;
  to.covariance(2, 2) = from->heading_variance;
  return to;
}

}  // namespace

cairn_vehicle_parameters cairn_vehicle_default_parameters(void) {
  const Tracker::Parameters from;
  return {from.odometry.sigma_speed_mps,
          from.odometry.sigma_turn,
          from.odometry.wheelbase_m,
          from.odometry.sample_period_s,
          from.sigma_px,
          from.floor.sigma_m,
          from.filter.tilt.sigma_pitch_rad,
          from.filter.tilt.sigma_roll_rad,
          from.filter.tilt.time_constant_s,
          from.work_limit,
          from.max_step_us,
          from.seed};
}

cairn_status cairn_vehicle_initialise(void* memory, size_t bytes, const cairn_camera* camera,
                                      const cairn_transform* T_vehicle_camera,
                                      const cairn_vehicle_start* start,
                                      const cairn_vehicle_parameters* parameters,
                                      cairn_vehicle** vehicle) {
  if (vehicle == nullptr) return CAIRN_INVALID_ARGUMENT;
  *vehicle = nullptr;
  if (camera == nullptr || T_vehicle_camera == nullptr ||
      !cairn::c_api::fits(memory, bytes, sizeof(cairn_vehicle))) {
    return CAIRN_INVALID_ARGUMENT;
  }
  auto* const made = new (memory) cairn_vehicle;
  made->parameters = parameters != nullptr ? *parameters : cairn_vehicle_default_parameters();
  const Status status =
      made->tracker.initialise(from_c(*camera), from_c(*T_vehicle_camera), start_from(start),
                               parameters_from(made->parameters));
  if (ok(status)) *vehicle = made;
  return to_c(status);
}

cairn_status cairn_vehicle_reset(cairn_vehicle* vehicle, const cairn_vehicle_start* start) {
  if (vehicle == nullptr) return CAIRN_INVALID_ARGUMENT;
  const cairn::PinholeCamera<float> camera = vehicle->tracker.camera();
  const Rigid<float> T_vehicle_camera = vehicle->tracker.T_vehicle_camera();
  const Status status = vehicle->tracker.initialise(camera, T_vehicle_camera, start_from(start),
                                                    parameters_from(vehicle->parameters));
  if (!ok(status)) return to_c(status);
  vehicle->report = cairn::FrameReport();
  vehicle->accepted = false;
  return CAIRN_OK;
}

cairn_status cairn_vehicle_add_odometry(cairn_vehicle* vehicle, const cairn_odometry* sample) {
  if (vehicle == nullptr || sample == nullptr) return CAIRN_INVALID_ARGUMENT;
  if (sample->kind != CAIRN_TWIST && sample->kind != CAIRN_ACKERMANN) return CAIRN_INVALID_ARGUMENT;
  cairn::OdometrySample own;
  own.t_us = sample->t_us;
  own.kind = sample->kind == CAIRN_ACKERMANN ? cairn::OdometrySample::Kind::kAckermann
                                             : cairn::OdometrySample::Kind::kTwist;
  own.speed_mps = sample->speed_mps;
  own.turn = sample->turn;
  return to_c(vehicle->tracker.add_odometry(own));
}

cairn_status cairn_vehicle_process_frame(cairn_vehicle* vehicle, const cairn_image* image,
                                         int64_t t_us, cairn_report* report) {
  if (vehicle == nullptr || image == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::process_frame(*vehicle, *image, t_us, report);
}

cairn_status cairn_vehicle_set_work_limit(cairn_vehicle* vehicle, int32_t units) {
  if (vehicle == nullptr) return CAIRN_INVALID_ARGUMENT;
  return to_c(vehicle->tracker.set_work_limit(units));
}

cairn_status cairn_vehicle_set_ticks(cairn_vehicle* vehicle, cairn_read_ticks read, void* context) {
  if (vehicle == nullptr) return CAIRN_INVALID_ARGUMENT;
  vehicle->ticks = {read, context};
  return CAIRN_OK;
}

cairn_status cairn_vehicle_get_pose(const cairn_vehicle* vehicle, cairn_vehicle_pose* pose) {
  if (vehicle == nullptr || pose == nullptr) return CAIRN_INVALID_ARGUMENT;
  const Rigid<float> T_map_vehicle = vehicle->tracker.T_map_vehicle();
  const cairn::Quaternion<float>& q = T_map_vehicle.rotation;
  pose->x_m = T_map_vehicle.translation.x();
  pose->y_m = T_map_vehicle.translation.y();
  pose->heading_rad = cairn::wrap_angle(2.0F * cairn::atan2(q.z(), q.w()));
  const cairn::Matrix3<float> covariance = vehicle->tracker.map_pose_covariance();
  for (int i = 0; i < 9; ++i) pose->covariance[i] = covariance(i / 3, i % 3);
  return CAIRN_OK;
}

cairn_status cairn_vehicle_get_landmarks(const cairn_vehicle* vehicle, cairn_landmark* landmarks,
                                         size_t capacity, size_t* count) {
  if (vehicle == nullptr || count == nullptr || (landmarks == nullptr && capacity != 0)) {
    return CAIRN_INVALID_ARGUMENT;
  }
  const Filter& filter = vehicle->tracker.filter();
  const Rigid<float> T_world_map = vehicle->tracker.T_world_map();
  *count = 0;
  for (int slot = 0; slot < filter.landmark_count() && *count < capacity; ++slot) {
    landmarks[(*count)++] = to_c(filter.landmark_id(slot), filter.mean_landmark(slot),
                                 filter.landmark_covariance(slot), T_world_map);
  }
  return CAIRN_OK;
}

cairn_status cairn_vehicle_get_health(const cairn_vehicle* vehicle, cairn_health* health) {
  if (vehicle == nullptr || health == nullptr) return CAIRN_INVALID_ARGUMENT;
  cairn::c_api::copy_health(vehicle->tracker.health(), *health);
  return CAIRN_OK;
}

uint64_t cairn_vehicle_hash(const cairn_vehicle* vehicle) {
  return vehicle != nullptr ? cairn::c_api::hash_of(*vehicle) : 0;
}

cairn_status cairn_vehicle_place_object(const cairn_vehicle* vehicle, cairn_objects* objects,
                                        float forward_m, float left_m) {
  if (vehicle == nullptr || objects == nullptr) return CAIRN_INVALID_ARGUMENT;
  if (!cairn::is_finite(forward_m) || !cairn::is_finite(left_m)) return CAIRN_NON_FINITE_INPUT;
  cairn::ObjectPlacement placement{{forward_m, left_m, 0.0F}, cairn::Random(1)};
  Rigid<float> T_map_object;
  if (!find_object_place(vehicle->tracker, placement, T_map_object)) return CAIRN_NOT_FOUND;
  return to_c(objects->augmenter.place(T_map_object));
}

cairn_status cairn_vehicle_draw(const cairn_vehicle* vehicle, cairn_objects* objects,
                                const cairn_canvas* canvas, int32_t* drawn) {
  if (vehicle == nullptr || objects == nullptr || canvas == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::draw(*vehicle, *objects, *canvas, drawn);
}

cairn_status cairn_vehicle_save_map(cairn_vehicle* vehicle, uint8_t* buffer, size_t size,
                                    size_t* used) {
  if (vehicle == nullptr || buffer == nullptr || used == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::save_map(*vehicle, buffer, size, *used);
}

cairn_status cairn_vehicle_load_map(cairn_vehicle* vehicle, const uint8_t* bytes, size_t size) {
  if (vehicle == nullptr || bytes == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::load_map(*vehicle, bytes, size);
}

cairn_status cairn_vehicle_write_map(cairn_vehicle* vehicle, cairn_write_bytes write,
                                     void* context) {
  if (vehicle == nullptr || write == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::write_map(*vehicle, write, context);
}

cairn_status cairn_vehicle_read_map(cairn_vehicle* vehicle, cairn_read_bytes read, void* context,
                                    uint32_t size) {
  if (vehicle == nullptr || read == nullptr) return CAIRN_INVALID_ARGUMENT;
  return cairn::c_api::read_map(*vehicle, read, context, size);
}
