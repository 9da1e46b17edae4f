#include "cairn/tracking/fixed_camera_pose.hpp"

#include "cairn/tracking/fixed_warp.hpp"

namespace cairn {

bool FixedCameraPose::see(const FixedCoordinate (&p_world)[3], FixedLength nearest,
                          FixedPixel (&pixel)[2]) const {
  std::uint32_t lost = 0;
  FixedLength away[3];
  for (int i = 0; i < 3; ++i) {
    away[i] =
        convert<FixedLength>(subtract(p_world[i], T_world_camera_.translation[i], lost), lost);
  }
  FixedLength p_camera[3];
  R_camera_world_.turn(away, p_camera, lost);
  return usable_ && lost == 0 && p_camera[2] >= nearest &&
         detail::project_point(camera_, p_camera, pixel, lost) && lost == 0 &&
         camera_.contains(pixel);
}

bool FixedCameraPose::predict(const Rigid<float>& T_world_reference,
                              const FixedLength (&p_camera)[3], PatchWarp& warp) const {
  std::uint32_t lost = 0;
  const FixedRigid reference = fixed_rigid_of(T_world_reference, lost);
  const detail::FixedMotionBetween motion =
      detail::motion_between(reference, T_world_camera_, lost);
  FixedLength p_reference[3];
  motion.R.turn(p_camera, p_reference, lost);
  for (int i = 0; i < 3; ++i) {
    p_reference[i] = add(p_reference[i], convert<FixedLength>(motion.t[i], lost), lost);
  }
  if (!usable_ || lost != 0) return false;
  FixedView first;
  FixedView present;
  first.depth = p_reference[2].raw();
  present.depth = p_camera[2].raw();
  return detail::project(camera_, p_reference, first.projection, lost) &&
         detail::project(camera_, p_camera, present.projection, lost) &&
         predict_patch_warp(camera_, first, present, motion.R.transposed(), warp);
}

}  // namespace cairn
