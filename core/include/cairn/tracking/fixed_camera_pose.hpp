#pragma once

#include "cairn/geometry/fixed_rigid.hpp"
#include "cairn/vision/patch.hpp"

namespace cairn {

/// Where the camera is in one picture, and its lens.
class FixedCameraPose {
 public:
  FixedCameraPose(const PinholeCamera<float>& camera, const FixedRigid& T_world_camera)
      : T_world_camera_(T_world_camera),
        R_camera_world_(detail::rotation_of(T_world_camera).transposed()) {
    usable_ = ok(fixed_of(camera, camera_));
  }
  const FixedCamera& camera() const { return camera_; }

  /// The pixel of a point of the world; false nearer than `nearest` or out of the picture.
  bool see(const FixedCoordinate (&p_world)[3], FixedLength nearest, FixedPixel (&pixel)[2]) const;

  /// As predict_warp(), of a point in the camera frame.
  bool predict(const Rigid<float>& T_world_reference, const FixedLength (&p_camera)[3],
               PatchWarp& warp) const;

 private:
  FixedCamera camera_;
  FixedRigid T_world_camera_;
  detail::FixedRotation R_camera_world_;
  bool usable_ = false;
};

}  // namespace cairn
