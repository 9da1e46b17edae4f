#pragma once

#include "cairn/estimation/observation.hpp"
#include "cairn/tracking/frame_context.hpp"
#include "cairn/tracking/mount_check.hpp"
#include "cairn/tracking/odometry_integrator.hpp"
#include "cairn/tracking/yaw_check.hpp"

namespace cairn {

/// What speaks against a vehicle's inputs, or against its pose, whether landmarks agree or not: the
/// mount and the odometry's turns as the pictures show them, and a heading that nothing has
/// corrected for a while.
class VehicleDoubt {
 public:
  /// Starts anew with the assumed camera and mount. `sigma_px`: standard deviation of a match.
  void reset(const PinholeCamera<float>& camera, const Rigid<float>& T_vehicle_camera,
             float sigma_px);

  /// Compares a frame's matches, used or not, and its picture with what odometry says of the
  /// `step_s` since the frame before. `tilt_noise`: variances that these add to pitch and roll,
  /// rad^2. Matches are compared where the frame can pay work::kMountCheck; the cost of
  /// work::kYawCheck is the caller's to pay.
  void compare(FrameContext& frame, const OdometryIntegrator& odometry,
               const Vector2<float>& tilt_noise, float step_s, const PixelMatch<float>* matches,
               int count);
  /// The pose was `seen` in the frame, or odometry's yaw of `yaw_variance` (rad^2) was all.
  void note_pose(bool seen, float yaw_variance) {
    unseen_yaw_ = seen ? 0.0F : unseen_yaw_ + yaw_variance;
  }
  /// The pose is taken for known.
  void trust_pose() { unseen_yaw_ = 0.0F; }

  /// Whether the pictures contradict the odometry, its turns or the mount, or it is silent, and so
  /// the scale is not measured.
  bool contradicts(const OdometryIntegrator& odometry) const {
    return odometry.contradicted() || !odometry.known() || mount_offset().any_suspect() ||
           yaw().suspect();
  }
  /// Whether, since the pose was last seen, the heading became so unsure that landmarks are not
  /// where they are expected: few of them in view say nothing, and matches in windows of that size
  /// are mostly chance. `yaw_variance`: of odometry since the last note_pose().
  bool heading_unsure(float yaw_variance) const;

  /// How far the mount and the focal length seem to be from what reset() was told.
  const MountOffset& mount_offset() const { return mount_.offset(); }
  /// Whether odometry turns as the pictures do.
  const YawCheck& yaw() const { return yaw_; }

 private:
  MountCheck mount_;
  YawCheck yaw_;
  float unseen_yaw_ = 0.0F;  ///< variance of odometry's yaw since the pose was seen, rad^2
};

}  // namespace cairn
