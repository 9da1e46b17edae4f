#pragma once

#include <cstdint>

#include "cairn/ar/line_drawing.hpp"
#include "cairn/ar/virtual_object.hpp"
#include "cairn/base/status.hpp"
#include "cairn/geometry/camera.hpp"
#include "cairn/geometry/rigid.hpp"
#include "cairn/vision/image.hpp"

namespace cairn {

struct DrawStyle {
  std::uint8_t line_grey = 255;
  std::uint8_t halo_grey = 0;
  int line_width_q8 = 400;   ///< 1/256 px
  int halo_width_q8 = 1000;  ///< drawn below all lines, so that they show on any ground; 0: none
  float near_m = 0.1F;       ///< nothing nearer to the image plane is drawn
  /// Work budget: once so many pixels are written, halos and lines counted apart, further pieces
  /// are left out. Reached only when the camera is so near that the object fills the image.
  int max_pixels = 40000;
};

struct DrawReport {
  int edges = 0;     ///< of faces that look at the camera
  int cut = 0;       ///< of these, edges of which a part was hidden by another convex part
  int segments = 0;  ///< straight pieces drawn, halos included
  int pixels = 0;    ///< written
  int left_out = 0;  ///< pieces not drawn because a limit was reached
};

/// Most pieces into which an edge is cut where the lens bends it,
inline constexpr int kLensPieces = 6;
/// and how far off the bent line a piece may be before there are more, px.
inline constexpr float kLensBend = 0.125F;
/// Most pieces of edges that are drawn; further ones are left out.
inline constexpr int kMaxVisiblePieces = 256;

/// Draws the wireframe of `object`, standing at T_world_object, as a camera at T_world_camera sees
/// it, into an 8-bit image of the camera's size. Hidden lines are removed exactly: edges between
/// two faces that look away are left out (back-face test), and from the others the intervals are
/// cut that lie in the shadow of another part. The shadow of a convex part is itself an
/// intersection of half-spaces (its front faces and the planes through the camera and its outline),
/// so that an edge loses one interval a part (Cyrus and Beck 1978). What remains is clipped at the
/// near plane, projected with the lens, clipped to the image and drawn in integers.
///
/// kInvalidArgument: the view is invalid or not of the camera's size. kNonFiniteInput: a pose is
/// not finite. kOutOfView: nothing to draw. The image is unchanged unless kOk. Cost: at most
/// kMaxParts * kMaxEdges edges, each against kMaxParts shadows of at most 32 planes, and
/// kMaxVisiblePieces lines (kLensPieces times as many where the lens bends them) no longer than the
/// image's diagonal, twice with a halo.
Status draw_object(const VirtualObject& object, const Rigid<float>& T_world_object,
                   const PinholeCamera<float>& camera, const Rigid<float>& T_world_camera,
                   const DrawStyle& style, const MutableImageView& image, DrawReport& report);

}  // namespace cairn
