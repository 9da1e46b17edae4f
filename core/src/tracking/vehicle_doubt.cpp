#include "cairn/tracking/vehicle_doubt.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {

void VehicleDoubt::reset(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera,
                         float sigma_px) {
  // The filter's sigma also stands for errors that last as long as their landmark, which two views
  // of it, at most two seconds apart, share.
  constexpr float kOfTwoViews = 0.5F;
  mount_.reset(camera, T_vehicle_camera, kOfTwoViews * sigma_px);
  yaw_.reset(camera, T_vehicle_camera);
  unseen_yaw_ = 0.0F;
}

void VehicleDoubt::compare(FrameContext& frame, const OdometryIntegrator& odometry,
                           const Vector2<float>& tilt_noise, float step_s,
                           const PixelMatch<float>* matches, int count) {
  if (odometry.known()) {
    const PlanarPose<float> path = odometry.path();
    const bool paid = frame.work.take(work::kMountCheck);
    const float tilt = tilt_noise.x() > tilt_noise.y() ? tilt_noise.x() : tilt_noise.y();
    mount_.add(frame.camera, {path, odometry.yaw_variance(), tilt, step_s}, matches,
               paid ? count : 0);
    frame.health.mount_suspicions += mount_offset().any_suspect() ? 1 : 0;
    yaw_.add(frame.image, {path.heading, odometry.yaw_variance(), odometry.speed_mps(), step_s});
  } else {
    yaw_.skip();
  }
  frame.health.yaw_suspicions += yaw_.suspect() ? 1 : 0;
}

bool VehicleDoubt::heading_unsure(float yaw_variance) const {
  constexpr float kMostYaw_rad = 0.12F;
  return unseen_yaw_ + yaw_variance > square(kMostYaw_rad);
}

}  // namespace cairn
