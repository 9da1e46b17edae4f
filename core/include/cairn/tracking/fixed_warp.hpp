#pragma once

#include "cairn/geometry/fixed_camera.hpp"
#include "cairn/vision/patch.hpp"

namespace cairn {

/// One view of a point: the derivatives of its pixel, and its depth in the unit of both views.
struct FixedView {
  detail::FixedProjection projection;
  std::int32_t depth = 0;
};

/// As predict_warp() and to_patch_warp(), of the views of a point by the camera of the reference
/// and by the present one; `R_camera_reference`: between them. False where an entry is beyond +-8.
bool predict_patch_warp(const FixedCamera& camera, const FixedView& reference,
                        const FixedView& present, const detail::FixedRotation& R_camera_reference,
                        PatchWarp& warp);

/// As a message in float.
Matrix2<float> matrix_of(const PatchWarp& warp);

}  // namespace cairn
