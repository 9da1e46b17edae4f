#pragma once

#include "cairn/estimation/observation.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/vision/freak.hpp"
#include "cairn/vision/image.hpp"
#include "cairn/vision/patch.hpp"

namespace cairn {

/// How a landmark looks: descriptor and patch of its reference view, and where that view was taken
/// from, so that a later view can be described at the predicted roll and scale.
struct Appearance {
  Descriptor descriptor;
  Patch patch;
  Rigid<float> T_world_reference;  ///< camera pose of the reference view
  std::uint8_t scale_index =
      0;                       ///< FREAK scale of the reference; its orientation bin is 0 (upright)
  bool has_patch = true;       ///< false: only a descriptor, as of a library landmark
  bool has_descriptor = true;  ///< false: only a patch, of a point near the image border
};

/// FREAK scale of reference views: room to shrink by 2^(4/16) before the finest pattern is reached.
inline constexpr int kReferenceScaleIndex = 4;

/// Affine map of the image around a landmark from its reference view to the current one, for a
/// small surface patch facing the reference camera: A = J_c R_cr J_r^+ (J: projection Jacobians at
/// the landmark, J_r^+ perpendicular to the reference ray). Offsets in px, current = A * reference.
/// kOutOfView when the landmark is behind either camera.
template <class T>
Status predict_warp(const PinholeCamera<T>& camera, const Rigid<T>& T_world_reference,
                    const Rigid<T>& T_world_camera, const Vector3<T>& p_camera, Matrix2<T>& warp);

/// FREAK pose that sees through `warp` what the reference pose saw: roll as orientation bin, change
/// of scale in sixteenths of an octave, clamped to 0..24. No effect of perspective shear.
template <class T>
FreakPose steer(const Matrix2<T>& warp, int reference_scale_index);

/// Scale change of the warp, sqrt(|det A|).
template <class T>
T warp_scale(const Matrix2<T>& warp);

/// Fixed-point form of `warp` for align_patch. False when an entry is beyond +-8.
template <class T>
bool to_patch_warp(const Matrix2<T>& warp, PatchWarp& fixed);

/// Takes the reference view of the corner at integer pixel (x, y). kOutOfView near the border.
Status make_appearance(const ImageView& image, int x, int y, const Rigid<float>& T_world_camera,
                       Appearance& appearance);

/// The same, but where the border is too near for a descriptor alone, without one: a patch needs 7
/// pixels around the corner, a descriptor four times as many. kOutOfView nearer than that.
Status make_patch_appearance(const ImageView& image, int x, int y,
                             const Rigid<float>& T_world_camera, Appearance& appearance);

}  // namespace cairn
