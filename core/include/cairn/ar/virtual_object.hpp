#pragma once

#include <cstdint>

#include "cairn/base/fixed_vector.hpp"
#include "cairn/base/status.hpp"
#include "cairn/geometry/types.hpp"

namespace cairn {

/// Convex polyhedron of a virtual object, object frame, m. Storage inside; faces are planar loops,
/// counter-clockwise seen from outside.
struct ConvexPart {
  static constexpr int kMaxVertices = 18;
  static constexpr int kMaxFaces = 14;
  static constexpr int kMaxEdges = 30;
  static constexpr int kMaxFaceVertices = 6;

  struct Face {
    std::uint8_t vertices[kMaxFaceVertices] = {};
    std::uint8_t vertex_count = 0;
    Vector3<float> normal = Vector3<float>::Zero();  ///< unit, outwards
    float offset = 0.0F;                             ///< normal . p = offset on the face
  };
  struct Edge {
    std::uint8_t a = 0;
    std::uint8_t b = 0;
    std::uint8_t face_left = 0;  ///< the two faces that meet in it
    std::uint8_t face_right = 0;
  };

  FixedVector<Vector3<float>, kMaxVertices> vertices;
  FixedVector<Face, kMaxFaces> faces;
  FixedVector<Edge, kMaxEdges> edges;
};

/// A virtual object: convex parts that do not overlap (they may touch). z up, origin on the ground.
struct VirtualObject {
  static constexpr int kMaxParts = 8;
  FixedVector<ConvexPart, kMaxParts> parts;
};

/// One ring of a stone or prism: a scaled, shifted copy of the base polygon at a height.
struct PartRing {
  float scale = 1.0F;
  float height_m = 0.0F;
  Vector2<float> shift_m = Vector2<float>::Zero();
};

/// Convex part from two or three rings of one convex polygon (3 to 6 corners, counter-clockwise
/// seen from above), heights ascending. kInvalidArgument for other counts, scales that are not
/// positive, heights that do not rise, or rings that make the part concave; `part` is then
/// unchanged.
Status make_ring_part(const Vector2<float>* corners, int corner_count, const PartRing* rings,
                      int ring_count, ConvexPart& part);

/// The project's own object: a cairn of six stones, `height_m` tall (> 0), standing on z = 0 about
/// the origin, about 0.9 times as wide as it is tall. kInvalidArgument, object unchanged, for a
/// height that is not positive and finite. Cost: a few thousand operations; make it once and keep
/// it.
Status make_cairn(float height_m, VirtualObject& object);

}  // namespace cairn
