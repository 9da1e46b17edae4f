#include "cairn/ar/object_drawing.hpp"

#include "edge_pieces.hpp"
#include "line_passes.hpp"

namespace cairn {
namespace {

using detail::EdgePiece;
using detail::EdgePieces;
using detail::LinePass;
using detail::VisiblePiece;
using detail::VisiblePieces;

/// Part of an edge, by its parameter in [0, 1].
struct Interval {
  float begin = 0.0F;
  float end = 1.0F;
};

/// normal . p <= offset.
struct HalfSpace {
  Vector3<float> normal;
  float offset;
  float touch;  // an edge so far inside, as a share of its length, still only touches

  HalfSpace() = default;
  HalfSpace(const Vector3<float>& n, float o)
      : normal(n), offset(o), touch(-1e-3F * sqrt(n.squaredNorm())) {}
};

/// The shadow of a convex part seen from `eye`: its front faces and the planes of its outline.
struct Shadow {
  FixedVector<HalfSpace, ConvexPart::kMaxFaces + ConvexPart::kMaxVertices> planes;
};

using FaceFlags = bool[ConvexPart::kMaxFaces];

int mark_front_faces(const ConvexPart& part, const Vector3<float>& eye, FaceFlags& front) {
  int count = 0;
  for (int f = 0; f < part.faces.size(); ++f) {
    front[f] = part.faces[f].normal.dot(eye) > part.faces[f].offset;
    count += front[f] ? 1 : 0;
  }
  return count;
}

/// False when the eye is inside the part: it has no outline then and hides nothing.
bool cast_shadow(const ConvexPart& part, const Vector3<float>& eye, Shadow& shadow) {
  FaceFlags front = {};
  if (mark_front_faces(part, eye, front) == 0) return false;
  shadow.planes.clear();
  Vector3<float> centre = Vector3<float>::Zero();
  for (const Vector3<float>& v : part.vertices) centre += v;
  centre /= static_cast<float>(part.vertices.size());
  for (int f = 0; f < part.faces.size(); ++f) {
    if (front[f]) shadow.planes.push_back(HalfSpace(part.faces[f].normal, part.faces[f].offset));
  }
  for (const ConvexPart::Edge& edge : part.edges) {
    if (front[edge.face_left] == front[edge.face_right]) continue;
    const Vector3<float> a = part.vertices[edge.a] - eye;
    const Vector3<float> b = part.vertices[edge.b] - eye;
    Vector3<float> normal = a.cross(b);
    if (normal.dot(Vector3<float>(centre - eye)) > 0.0F) normal = -normal;
    shadow.planes.push_back(HalfSpace(normal, normal.dot(eye)));
  }
  return true;
}

/// What is to be seen of an edge.
struct EdgeView {
  EdgePieces pieces;  // empty: the edge is hidden
  bool cut = false;
};

/// The interval of a + t (b - a) inside the shadow, slightly shrunk, so that an edge that touches
/// the part survives. False when there is none.
bool inside_shadow(const Shadow& shadow, const Vector3<float>& a, const Vector3<float>& b,
                   Interval& hidden) {
  const float length = sqrt((b - a).squaredNorm());
  hidden = Interval();
  for (const HalfSpace& plane : shadow.planes) {
    const float limit = plane.touch * length;
    const float at_a = plane.normal.dot(a) - plane.offset - limit;
    const float at_b = plane.normal.dot(b) - plane.offset - limit;
    if (at_a > 0.0F && at_b > 0.0F) return false;
    if (at_a <= 0.0F && at_b <= 0.0F) continue;
    const float t = at_a / (at_a - at_b);
    if (at_a > 0.0F) {
      if (t > hidden.begin) hidden.begin = t;
    } else if (t < hidden.end) {
      hidden.end = t;
    }
  }
  return hidden.end > hidden.begin;
}

std::uint16_t to_share(float t) {
  return static_cast<std::uint16_t>(clamp(round_to_int(t * 65535.0F), 0, 65535));
}
float from_share(std::uint16_t share) {
  return static_cast<float>(share) / 65535.0F;
}

/// Everything that drawing a segment needs.
struct Canvas {
  const PinholeCamera<float>& camera;
  const Rigid<float>& T_camera_object;
  LinePass& pass;
};

/// Draws one straight piece between two pixels.
void draw_piece(Canvas& canvas, const Vector2<float>& from, const Vector2<float>& to) {
  if (!canvas.pass.has_room()) return;
  const float ends[] = {from.x(), from.y(), to.x(), to.y()};
  std::int32_t q8[4];
  for (int k = 0; k < 4; ++k) q8[k] = round_to_int(clamp(ends[k], -1e6F, 1e6F) * 256.0F);
  canvas.pass.draw({q8[0], q8[1], q8[2], q8[3]}, draw_line);
}

/// Distance of `p` from the straight line through `a` and `b`, in px; of `a` where both are one.
float off_line(const Vector2<float>& a, const Vector2<float>& b, const Vector2<float>& p) {
  const Vector2<float> along = b - a;
  const Vector2<float> to_p = p - a;
  const float length = sqrt(along.squaredNorm());
  if (length < 1.0F) return sqrt(to_p.squaredNorm());
  return abs(along.x() * to_p.y() - along.y() * to_p.x()) / length;
}

/// Into how many straight pieces an edge is cut so that none is off the bent line by more than
/// kLensBend: what lies between falls with the square of their number. Points in the camera frame.
int count_pieces(const PinholeCamera<float>& camera, const Vector3<float>& a,
                 const Vector3<float>& b) {
  if (!camera.has_distortion()) return 1;
  Vector2<float> pixels[4];
  for (int k = 0; k < 4; ++k) {
    const float t = static_cast<float>(k) / 3.0F;
    if (!ok(camera.project(Vector3<float>(a + t * (b - a)), pixels[k]))) return kLensPieces;
  }
  float bend = 0.0F;
  for (int k = 1; k < 3; ++k) {
    const float off = off_line(pixels[0], pixels[3], pixels[k]);
    if (off > bend) bend = off;
  }
  int pieces = 1;
  while (pieces < kLensPieces && bend > kLensBend * static_cast<float>(pieces * pieces)) ++pieces;
  return pieces;
}

/// Draws the segment between two points of the object frame, clipped at the near plane.
void draw_segment(Canvas& canvas, const Vector3<float>& a_object, const Vector3<float>& b_object) {
  Vector3<float> a = canvas.T_camera_object * a_object;
  Vector3<float> b = canvas.T_camera_object * b_object;
  const float near = canvas.pass.style.near_m > PinholeCamera<float>::kMinDepth
                         ? canvas.pass.style.near_m
                         : PinholeCamera<float>::kMinDepth;
  if (a.z() < near && b.z() < near) return;
  if (a.z() < near || b.z() < near) {
    const float t = (near - a.z()) / (b.z() - a.z());
    Vector3<float> crossing = a + t * (b - a);
    crossing.z() = near;
    (a.z() < near ? a : b) = crossing;
  }
  const int pieces = count_pieces(canvas.camera, a, b);
  Vector2<float> from;
  bool from_seen = ok(canvas.camera.project(a, from));
  for (int k = 1; k <= pieces; ++k) {
    const float t = static_cast<float>(k) / static_cast<float>(pieces);
    Vector2<float> to;
    const bool to_seen = ok(canvas.camera.project(Vector3<float>(a + t * (b - a)), to));
    if (from_seen && to_seen) draw_piece(canvas, from, to);
    from = to;
    from_seen = to_seen;
  }
}

/// What is to be seen of the edges of part `p`.
void find_visible_edges(const VirtualObject& object, int p, const Vector3<float>& eye,
                        EdgeView* edges) {
  const ConvexPart& part = object.parts[p];
  FaceFlags front = {};
  mark_front_faces(part, eye, front);
  for (int e = 0; e < part.edges.size(); ++e) {
    const ConvexPart::Edge& edge = part.edges[e];
    edges[e] = EdgeView();
    if (front[edge.face_left] || front[edge.face_right]) edges[e].pieces.push_back(EdgePiece());
  }
  for (int q = 0; q < object.parts.size(); ++q) {
    Shadow shadow;
    if (q == p || !cast_shadow(object.parts[q], eye, shadow)) continue;
    for (int e = 0; e < part.edges.size(); ++e) {
      const ConvexPart::Edge& edge = part.edges[e];
      Interval inside;
      if (edges[e].pieces.empty() ||
          !inside_shadow(shadow, part.vertices[edge.a], part.vertices[edge.b], inside)) {
        continue;
      }
      const EdgePiece hidden{to_share(inside.begin), to_share(inside.end)};
      if (hidden.end <= hidden.begin) continue;
      edges[e].cut = true;
      cut(hidden, edges[e].pieces);
    }
  }
}

void find_visible_pieces(const VirtualObject& object, const Vector3<float>& eye,
                         VisiblePieces& visible, DrawReport& report) {
  for (int p = 0; p < object.parts.size(); ++p) {
    EdgeView edges[ConvexPart::kMaxEdges];
    find_visible_edges(object, p, eye, edges);
    add_visible(p, edges, object.parts[p].edges.size(), visible, report);
  }
}

void draw_pieces(const VirtualObject& object, const VisiblePieces& visible, Canvas& canvas) {
  for (const VisiblePiece& each : visible) {
    const ConvexPart& part = object.parts[each.part];
    const Vector3<float>& a = part.vertices[part.edges[each.edge].a];
    const Vector3<float>& b = part.vertices[part.edges[each.edge].b];
    draw_segment(canvas, Vector3<float>(a + from_share(each.piece.begin) * (b - a)),
                 Vector3<float>(a + from_share(each.piece.end) * (b - a)));
  }
}

bool finite_pose(const Rigid<float>& pose) {
  return is_finite(pose.translation.sum()) && is_finite(pose.rotation.coeffs().sum());
}

}  // namespace

Status draw_object(const VirtualObject& object, const Rigid<float>& T_world_object,
                   const PinholeCamera<float>& camera, const Rigid<float>& T_world_camera,
                   const DrawStyle& style, const MutableImageView& image, DrawReport& report) {
  if (!ImageView(image).valid() || image.width != camera.width || image.height != camera.height ||
      !is_finite(style.near_m)) {
    return Status::kInvalidArgument;
  }
  if (!finite_pose(T_world_object) || !finite_pose(T_world_camera)) return Status::kNonFiniteInput;
  const Rigid<float> T_camera_object = T_world_camera.inverse() * T_world_object;
  const Vector3<float> eye = T_camera_object.inverse().translation;
  DrawReport result;
  VisiblePieces visible;
  find_visible_pieces(object, eye, visible, result);
  const Status status = detail::draw_passes(style, image, result, [&](LinePass& pass) {
    Canvas canvas = {camera, T_camera_object, pass};
    draw_pieces(object, visible, canvas);
  });
  report = result;
  return status;
}

}  // namespace cairn
