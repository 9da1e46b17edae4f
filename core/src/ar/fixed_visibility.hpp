#pragma once

#include "cairn/ar/object_drawing.hpp"
#include "cairn/base/fixed_vector.hpp"
#include "cairn/geometry/fixed_camera.hpp"
#include "cairn/numeric/float_bits.hpp"

namespace cairn::detail {

inline constexpr std::uint32_t kWholeEdge = 65535;

/// m, FixedLength's format.
struct Point {
  std::int32_t at[3];
};

/// Part of an edge, in 1/65535 of its length.
struct EdgePiece {
  std::uint16_t begin = 0;
  std::uint16_t end = kWholeEdge;
};

/// The object as the camera sees it.
struct ObjectScene {
  const VirtualObject& object;
  Point vertices[VirtualObject::kMaxParts][ConvexPart::kMaxVertices];  ///< from the eye
  std::uint32_t front[VirtualObject::kMaxParts];  ///< a bit for each face that looks at the eye

  bool is_front(int part, int face) const { return (front[part] >> face & 1U) != 0U; }
};

/// What is to be seen of the object's edges, for both passes.
struct VisiblePiece {
  std::uint8_t part = 0;
  std::uint8_t edge = 0;
  EdgePiece piece;
};
using VisiblePieces = FixedVector<VisiblePiece, kMaxVisiblePieces>;

/// False where a vertex is 512 m or more from the eye. `scene` has its object.
bool make_scene(const Point& eye, ObjectScene& scene);

/// Turns the scene's vertices to the camera's axes afterwards.
void find_visible_pieces(ObjectScene& scene, const FixedRotation& R_camera_object,
                         VisiblePieces& visible, DrawReport& report);

/// a / (a + b), both above or at 0, one of them above.
std::uint16_t share_of(std::int64_t a, std::int64_t b);

}  // namespace cairn::detail
