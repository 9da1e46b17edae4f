#include "fixed_visibility.hpp"

namespace cairn::detail {
namespace {

using Count = std::uint32_t;
constexpr int kFarthestBits = 29;  // of a coordinate: products of two and their sums fit 64 bits
constexpr int kShareBits = 16;

struct HalfSpace {  // normal . p <= offset, p from the eye
  std::int32_t normal[3];
  std::int64_t offset;

  /// Of the normal, the sum of its coordinates' magnitudes.
  std::int64_t length() const {
    std::int64_t sum = 0;
    for (const std::int32_t n : normal) sum += n < 0 ? -std::int64_t{n} : n;
    return sum;
  }
};
std::int64_t dot(const std::int32_t (&a)[3], const Point& p) {
  return std::int64_t{a[0]} * p.at[0] + std::int64_t{a[1]} * p.at[1] + std::int64_t{a[2]} * p.at[2];
}

void set_normal(const Vector3<float>& normal, HalfSpace& plane) {
  Count none = 0;
  for (int i = 0; i < 3; ++i) plane.normal[i] = fixed_of<FixedRatio>(normal(i), none).raw();
}

/// The plane through the eye and an edge of the outline, `inside` on its inner side.
HalfSpace outline_plane(const Point& a, const Point& b, const Point& inside) {
  std::int64_t n[3];
  std::uint64_t largest = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    n[i] = std::int64_t{a.at[j]} * b.at[k] - std::int64_t{a.at[k]} * b.at[j];
    largest |= wide::magnitude(n[i]);
  }
  const int shift = wide::bit_length(largest) - 30;
  HalfSpace plane = {};
  for (int i = 0; i < 3; ++i) {
    plane.normal[i] = static_cast<std::int32_t>(shift > 0 ? n[i] >> shift : n[i]);
  }
  if (dot(plane.normal, inside) > 0) {
    for (std::int32_t& value : plane.normal) value = -value;
  }
  return plane;
}

/// A point in the direction of a part's middle.
Point middle_of(const ConvexPart& part, const Point* vertices) {
  constexpr int kMostBits = 5;
  static_assert(ConvexPart::kMaxVertices <= 1 << kMostBits, "the sum fits");
  Point middle = {};
  for (int i = 0; i < 3; ++i) {
    std::int64_t sum = 0;
    for (int k = 0; k < part.vertices.size(); ++k) sum += vertices[k].at[i];
    middle.at[i] = static_cast<std::int32_t>(sum >> kMostBits);
  }
  return middle;
}

/// The shadow of a convex part: the planes of its outline and of its front faces.
class Shadow {
 public:
  Shadow(const ObjectScene& scene, int q, const Point& inside)
      : scene_(scene),
        part_(scene.object.parts[q]),
        vertices_(scene.vertices[q]),
        q_(q),
        inside_(inside) {}

  bool next(HalfSpace& plane) {
    while (edge_ < part_.edges.size()) {
      const ConvexPart::Edge& edge = part_.edges[edge_++];
      if (scene_.is_front(q_, edge.face_left) == scene_.is_front(q_, edge.face_right)) continue;
      plane = outline_plane(vertices_[edge.a], vertices_[edge.b], inside_);
      return true;
    }
    while (face_ < part_.faces.size()) {
      const int face = face_++;
      if (!scene_.is_front(q_, face)) continue;
      set_normal(part_.faces[face].normal, plane);
      plane.offset = dot(plane.normal, vertices_[part_.faces[face].vertices[0]]);
      return true;
    }
    return false;
  }

 private:
  const ObjectScene& scene_;
  const ConvexPart& part_;
  const Point* vertices_;
  int q_;
  const Point& inside_;
  int edge_ = 0;
  int face_ = 0;
};

/// Whether the part `p`, whose vertices' mean lies in the direction of `middle`, lies outside one
/// plane of a shadow, as most do.
bool lies_outside(Shadow shadow, const ConvexPart& p, const Point* vertices, const Point& middle) {
  HalfSpace plane = {};
  while (shadow.next(plane)) {
    const auto is_outside = [&](const Point& point) {
      return dot(plane.normal, point) > plane.offset;
    };
    if (!is_outside(middle)) continue;
    int outside = 0;
    while (outside < p.vertices.size() && is_outside(vertices[outside])) ++outside;
    if (outside == p.vertices.size()) return true;
  }
  return false;
}

/// What is to be seen of an edge, and what one shadow hides of it.
struct EdgeView {
  EdgePieces pieces;  ///< empty: the edge is hidden
  bool cut = false;
  bool inside = false;     ///< may still be inside the shadow
  EdgePiece hidden;        ///< of the shadow
  std::int64_t touch = 0;  ///< by which it may enter a part, m
};

/// Takes one half-space into the hidden intervals of a part's edges, of which `most_touch` is the
/// largest touch. False when nothing of them is inside.
bool cut_by_plane(const HalfSpace& plane, const ConvexPart& part, const Point* vertices,
                  std::int64_t most_touch, EdgeView* edges) {
  const std::int64_t length = plane.length();
  std::int64_t distance[ConvexPart::kMaxVertices];
  std::int64_t nearest = INT64_MAX;
  std::int64_t farthest = INT64_MIN;
  for (int k = 0; k < part.vertices.size(); ++k) {
    distance[k] = dot(plane.normal, vertices[k]) - plane.offset;
    nearest = distance[k] < nearest ? distance[k] : nearest;
    farthest = distance[k] > farthest ? distance[k] : farthest;
  }
  if (nearest > 0) return false;
  if (farthest + most_touch * length <= 0) return true;
  bool any = false;
  for (int e = 0; e < part.edges.size(); ++e) {
    EdgeView& edge = edges[e];
    if (!edge.inside) continue;
    const std::int64_t margin = edge.touch * length;
    const std::int64_t at_a = distance[part.edges[e].a] + margin;
    const std::int64_t at_b = distance[part.edges[e].b] + margin;
    if (at_a > 0 && at_b > 0) {
      edge.inside = false;
      continue;
    }
    any = true;
    if (at_a <= 0 && at_b <= 0) continue;
    if (at_a > 0) {
      const std::uint16_t t = share_of(at_a, -at_b);
      if (t > edge.hidden.begin) edge.hidden.begin = t;
    } else {
      const std::uint16_t t = share_of(-at_a, at_b);
      if (t < edge.hidden.end) edge.hidden.end = t;
    }
  }
  return any;
}

/// What is to be seen of the edges of part `p`.
void find_visible_edges(const ObjectScene& scene, const Point* middles, int p, EdgeView* edges) {
  constexpr int kTouchBits = 11;  // 1/2048 of the length
  const ConvexPart& part = scene.object.parts[p];
  const Point* const vertices = scene.vertices[p];
  std::int64_t most_touch = 0;
  for (int e = 0; e < part.edges.size(); ++e) {
    const ConvexPart::Edge& edge = part.edges[e];
    edges[e].pieces.clear();
    edges[e].cut = false;
    if (!scene.is_front(p, edge.face_left) && !scene.is_front(p, edge.face_right)) continue;
    edges[e].pieces.push_back(EdgePiece());
    std::int64_t length = 0;
    for (int i = 0; i < 3; ++i) {
      const std::int64_t by = std::int64_t{vertices[edge.b].at[i]} - vertices[edge.a].at[i];
      length += by < 0 ? -by : by;
    }
    edges[e].touch = length >> kTouchBits;
    most_touch = edges[e].touch > most_touch ? edges[e].touch : most_touch;
  }
  for (int q = 0; q < scene.object.parts.size(); ++q) {
    // With the eye inside a part it has no outline, and hides nothing.
    if (q == p || scene.front[q] == 0) continue;
    Shadow shadow(scene, q, middles[q]);
    if (lies_outside(shadow, part, vertices, middles[p])) continue;
    bool any = false;
    for (int e = 0; e < part.edges.size(); ++e) {
      edges[e].inside = !edges[e].pieces.empty();
      edges[e].hidden = EdgePiece();
      any = any || edges[e].inside;
    }
    HalfSpace plane = {};
    while (any && shadow.next(plane)) {
      any = cut_by_plane(plane, part, vertices, most_touch, edges);
    }
    for (int e = 0; any && e < part.edges.size(); ++e) {
      if (!edges[e].inside || edges[e].hidden.end <= edges[e].hidden.begin) continue;
      edges[e].cut = true;
      cut(edges[e].hidden, edges[e].pieces);
    }
  }
}

}  // namespace

/// False where a vertex is too far away.
bool make_scene(const Point& eye, ObjectScene& scene) {
  Count lost = 0;
  for (int p = 0; p < scene.object.parts.size(); ++p) {
    const ConvexPart& part = scene.object.parts[p];
    for (int k = 0; k < part.vertices.size(); ++k) {
      for (int i = 0; i < 3; ++i) {
        const std::int64_t from_eye =
            std::int64_t{fixed_of<FixedLength>(part.vertices[k](i), lost).raw()} - eye.at[i];
        if (wide::bit_length(wide::magnitude(from_eye)) > kFarthestBits) return false;
        scene.vertices[p][k].at[i] = static_cast<std::int32_t>(from_eye);
      }
    }
    scene.front[p] = 0;
    for (int f = 0; f < part.faces.size(); ++f) {
      HalfSpace plane;
      set_normal(part.faces[f].normal, plane);
      const Point& on_face = scene.vertices[p][part.faces[f].vertices[0]];
      if (dot(plane.normal, on_face) < 0) scene.front[p] |= 1U << f;
    }
  }
  return lost == 0;
}

/// a / (a + b), both above or at 0, one of them above.
std::uint16_t share_of(std::int64_t a, std::int64_t b) {
  const std::uint64_t sum = static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b);
  const int down = wide::bit_length(sum) - kShareBits;
  if (down <= 0) {
    return static_cast<std::uint16_t>(static_cast<std::uint32_t>(a) * kWholeEdge /
                                      static_cast<std::uint32_t>(sum));
  }
  const auto part = static_cast<std::uint32_t>(static_cast<std::uint64_t>(a) >> down);
  return static_cast<std::uint16_t>(part * kWholeEdge / static_cast<std::uint32_t>(sum >> down));
}

/// Turns the scene's vertices to the camera's axes afterwards.
void find_visible_pieces(ObjectScene& scene, const FixedRotation& R_camera_object,
                         VisiblePieces& visible, DrawReport& report) {
  const int parts = scene.object.parts.size();
  Point middles[VirtualObject::kMaxParts];
  for (int p = 0; p < parts; ++p) middles[p] = middle_of(scene.object.parts[p], scene.vertices[p]);
  EdgeView edges[ConvexPart::kMaxEdges];
  for (int p = 0; p < parts; ++p) {
    find_visible_edges(scene, middles, p, edges);
    add_visible(p, edges, scene.object.parts[p].edges.size(), visible, report);
  }
  Count none = 0;
  for (int p = 0; p < parts; ++p) {
    for (int k = 0; k < scene.object.parts[p].vertices.size(); ++k) {
      Point& vertex = scene.vertices[p][k];
      FixedLength v[3];
      FixedLength turned[3];
      for (int i = 0; i < 3; ++i) v[i] = FixedLength::from_raw(vertex.at[i]);
      R_camera_object.turn(v, turned, none);
      for (int i = 0; i < 3; ++i) vertex.at[i] = turned[i].raw();
    }
  }
}

}  // namespace cairn::detail
