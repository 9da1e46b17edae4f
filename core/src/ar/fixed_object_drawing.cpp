#include "cairn/ar/fixed_object_drawing.hpp"

#include "fixed_visibility.hpp"
#include "line_passes.hpp"

namespace cairn {
namespace {

using Count = std::uint32_t;
using detail::kWholeEdge;
using detail::LinePass;
using detail::ObjectScene;
using detail::Point;
using detail::share_of;
using detail::VisiblePiece;
using detail::VisiblePieces;

/// Everything that drawing a segment needs.
struct Canvas {
  const FixedCamera& camera;
  std::int32_t near;
  LinePass& pass;
};

/// from + share (to - from).
Point between(const Point& from, const Point& to, std::uint32_t share) {
  if (share == 0) return from;
  if (share >= kWholeEdge) return to;
  Point out = {};
  for (int i = 0; i < 3; ++i) {
    const std::int64_t part = (std::int64_t{to.at[i]} - from.at[i]) * share;
    out.at[i] = from.at[i] + static_cast<std::int32_t>((part + (part >> 16)) >> 16);
  }
  return out;
}

/// Where a point of the camera frame is in the picture, 1/256 px. False outside the camera's model.
bool see(const Canvas& canvas, const Point& p, std::int32_t& x_q8, std::int32_t& y_q8) {
  constexpr int kDown = FixedPixel::kFractionBits - 8;
  const FixedLength p_camera[3] = {FixedLength::from_raw(p.at[0]), FixedLength::from_raw(p.at[1]),
                                   FixedLength::from_raw(p.at[2])};
  FixedPixel pixel[2];
  Count none = 0;
  if (!detail::project_point(canvas.camera, p_camera, pixel, none)) return false;
  x_q8 = static_cast<std::int32_t>(wide::round_shift(pixel[0].raw(), kDown));
  y_q8 = static_cast<std::int32_t>(wide::round_shift(pixel[1].raw(), kDown));
  return true;
}

void draw_piece(Canvas& canvas, const LineQ8& line) {
  if (canvas.pass.has_room()) canvas.pass.draw(line, draw_line_in_integers);
}

/// Into how many straight pieces an edge is cut, as draw_object() does: none is off the bent line
/// by more than kLensBend.
int count_pieces(const Canvas& canvas, const Point& a, const Point& b) {
  constexpr auto kBend_q8 = static_cast<std::int64_t>(256 * kLensBend);
  constexpr std::int64_t kFarthest_q8 = 1 << 28;
  std::int64_t x[4];
  std::int64_t y[4];
  for (int k = 0; k < 4; ++k) {
    std::int32_t x_q8 = 0;
    std::int32_t y_q8 = 0;
    if (!see(canvas, between(a, b, static_cast<std::uint32_t>(k) * (kWholeEdge / 3)), x_q8, y_q8)) {
      return kLensPieces;
    }
    x[k] = std::int64_t{x_q8} - (k == 0 ? 0 : x[0]);
    y[k] = std::int64_t{y_q8} - (k == 0 ? 0 : y[0]);
    if (k > 0 && (wide::magnitude(x[k]) | wide::magnitude(y[k])) >= kFarthest_q8)
      return kLensPieces;
  }
  const FixedRoot length = square_root(x[3] * x[3] + y[3] * y[3], 0);
  std::int64_t bend = 0;  // twice the area under the line
  for (int k = 1; k < 3; ++k) {
    const std::int64_t area = x[3] * y[k] - y[3] * x[k];
    bend = area > bend ? area : (-area > bend ? -area : bend);
  }
  Count none = 0;
  const std::int64_t allowed = wide::scale(kBend_q8 * length.mantissa, -length.bits, none);
  int pieces = 1;
  while (pieces < kLensPieces && bend > allowed * pieces * pieces) ++pieces;
  return pieces;
}

/// Draws the segment between two points of the camera frame, clipped at the near plane.
void draw_segment(Canvas& canvas, Point a, Point b) {
  const std::int32_t near = canvas.near;
  if (a.at[2] < near && b.at[2] < near) return;
  if (a.at[2] < near || b.at[2] < near) {
    Point crossing =
        a.at[2] < near
            ? between(a, b, share_of(near - std::int64_t{a.at[2]}, std::int64_t{b.at[2]} - near))
            : between(a, b, share_of(std::int64_t{a.at[2]} - near, near - std::int64_t{b.at[2]}));
    crossing.at[2] = near;
    (a.at[2] < near ? a : b) = crossing;
  }
  LineQ8 line;
  bool seen = see(canvas, a, line.x0, line.y0);
  const bool straight = !canvas.camera.has_distortion();
  if (straight && seen && see(canvas, b, line.x1, line.y1)) return draw_piece(canvas, line);
  const int pieces = straight ? kLensPieces : count_pieces(canvas, a, b);
  for (int k = 1; k <= pieces; ++k) {
    const std::uint32_t share =
        static_cast<std::uint32_t>(k) * kWholeEdge / static_cast<std::uint32_t>(pieces);
    const bool sees_end = see(canvas, between(a, b, share), line.x1, line.y1);
    if (seen && sees_end) draw_piece(canvas, line);
    seen = sees_end;
    line.x0 = line.x1;
    line.y0 = line.y1;
  }
}

void draw_pieces(const ObjectScene& scene, const VisiblePieces& visible, Canvas& canvas) {
  for (const VisiblePiece& seen : visible) {
    const ConvexPart::Edge& edge = scene.object.parts[seen.part].edges[seen.edge];
    const Point& a = scene.vertices[seen.part][edge.a];
    const Point& b = scene.vertices[seen.part][edge.b];
    draw_segment(canvas, between(a, b, seen.piece.begin), between(a, b, seen.piece.end));
  }
}

}  // namespace

Status draw_object_in_integers(const VirtualObject& object, const Rigid<float>& T_world_object,
                               const FixedCamera& camera, const Rigid<float>& T_world_camera,
                               const DrawStyle& style, const MutableImageView& image,
                               DrawReport& report) {
  constexpr FixedLength kLeastDepth = FixedLength::nearest(0.05);
  Count lost = 0;
  const auto near = fixed_of<FixedLength>(style.near_m, lost);
  if (!ImageView(image).valid() || image.width != camera.width || image.height != camera.height ||
      lost != 0) {
    return Status::kInvalidArgument;
  }
  const FixedMount placed = fixed_of(T_world_object, lost);
  const FixedMount looking = fixed_of(T_world_camera, lost);
  if (lost != 0) return Status::kOutOfView;
  const detail::FixedRotation R_object_world = detail::rotation_of(placed).transposed();
  const detail::FixedRotation R_camera_object =
      detail::rotation_of(looking).transposed() * R_object_world.transposed();
  FixedLength away[3];
  FixedLength eye[3];
  for (int i = 0; i < 3; ++i) away[i] = subtract(looking.origin[i], placed.origin[i], lost);
  R_object_world.turn(away, eye, lost);
  ObjectScene scene = {object, {}, {}};
  if (lost != 0 || !detail::make_scene({{eye[0].raw(), eye[1].raw(), eye[2].raw()}}, scene)) {
    return Status::kOutOfView;
  }
  DrawReport result;
  VisiblePieces visible;
  detail::find_visible_pieces(scene, R_camera_object, visible, result);
  const std::int32_t nearest = (near < kLeastDepth ? kLeastDepth : near).raw();
  const Status status = detail::draw_passes(style, image, result, [&](LinePass& pass) {
    Canvas canvas = {camera, nearest, pass};
    draw_pieces(scene, visible, canvas);
  });
  report = result;
  return status;
}

}  // namespace cairn
