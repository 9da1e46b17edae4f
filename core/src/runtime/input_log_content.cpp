#include "cairn/runtime/input_log_content.hpp"

namespace cairn {
namespace {

bool is_within(float value, float low, float high) {
  return value >= low && value <= high;  // false for NaN
}

bool is_unit(const Quaternion<float>& q) {
  return is_within(q.squaredNorm(), 0.999F, 1.001F);
}

}  // namespace

Status InputLogHeader::validate() const {
  const Status camera_status = camera.validate();
  if (!ok(camera_status)) return Status::kBadConfig;
  const float far_m = 1e6F;
  const bool places = is_unit(T_vehicle_camera.rotation) &&
                      is_within(T_vehicle_camera.translation.x(), -far_m, far_m) &&
                      is_within(T_vehicle_camera.translation.y(), -far_m, far_m) &&
                      is_within(T_vehicle_camera.translation.z(), -far_m, far_m) &&
                      is_within(start_x_m, -far_m, far_m) && is_within(start_y_m, -far_m, far_m) &&
                      is_within(start_theta_rad, -1e4F, 1e4F);
  const bool noises = is_within(speed_sigma_mps, 0.0F, 1e3F) && is_within(turn_sigma, 0.0F, 1e3F) &&
                      is_within(wheelbase_m, 0.0F, 1e3F) &&
                      is_within(start_position_variance, 0.0F, 1e6F) &&
                      is_within(start_heading_variance, 0.0F, 1e3F);
  const bool rates = is_within(odometry_period_s, 1e-4F, 1e2F) &&
                     is_within(frame_rate_hz, 1e-2F, 1e4F) && is_within(fading, 1.0F, 2.0F) &&
                     focal_sigma_e4 <= 10000;
  return places && noises && rates && tilt.valid() && ok(gyro.validate()) &&
                 ok(readout.validate(camera.width, camera.height))
             ? Status::kOk
             : Status::kBadConfig;
}

}  // namespace cairn
