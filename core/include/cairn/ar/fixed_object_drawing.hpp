#pragma once

#include "cairn/ar/object_drawing.hpp"
#include "cairn/geometry/fixed_camera.hpp"
#include "cairn/numeric/float_bits.hpp"

namespace cairn {

/// draw_object() for cores without a floating-point unit: poses and shape become fixed point by
/// their bits, everything else is integers. The same lines to a fraction of a pixel, not the same
/// bytes. An edge survives a part that it touches where it enters it by no more than a thousandth
/// or two of its length.
///
/// Errors and cost: as draw_object(). kOutOfView also for an object with a vertex 512 m or more
/// from the camera, and for a pose farther than 2048 m from the origin.
Status draw_object_in_integers(const VirtualObject& object, const Rigid<float>& T_world_object,
                               const FixedCamera& camera, const Rigid<float>& T_world_camera,
                               const DrawStyle& style, const MutableImageView& image,
                               DrawReport& report);

}  // namespace cairn
