#pragma once

#include "cairn/ar/object_drawing.hpp"
#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/fixed_camera.hpp"
#include "cairn/numeric/float_bits.hpp"

#include "edge_pieces.hpp"

namespace cairn::detail {

/// m, FixedLength's format.
struct Point {
  std::int32_t at[3];
};

/// The object as the camera sees it.
struct ObjectScene {
  const VirtualObject& object;
  Point vertices[VirtualObject::kMaxParts][ConvexPart::kMaxVertices];  ///< from the eye
  std::uint32_t front[VirtualObject::kMaxParts];  ///< a bit for each face that looks at the eye

  bool is_front(int part, int face) const { return (front[part] >> face & 1U) != 0U; }
};

/// False where a vertex is 512 m or more from the eye. `scene` has its object.
bool make_scene(const Point& eye, ObjectScene& scene);

/// Turns the scene's vertices to the camera's axes afterwards.
void find_visible_pieces(ObjectScene& scene, const FixedRotation& R_camera_object,
                         VisiblePieces& visible, DrawReport& report);

/// a / (a + b), both above or at 0, one of them above.
std::uint16_t share_of(std::int64_t a, std::int64_t b);

}  // namespace cairn::detail
