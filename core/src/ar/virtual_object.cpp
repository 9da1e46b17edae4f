#include "cairn/ar/virtual_object.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr int kMinCorners = 3;
constexpr int kMaxCorners = 6;
constexpr int kMaxRings = 3;

std::uint8_t index8(int i) {
  return static_cast<std::uint8_t>(i);
}

bool finite2(const Vector2<float>& v) {
  return is_finite(v.x()) && is_finite(v.y());
}

bool rings_are_valid(const PartRing* rings, int count) {
  for (int r = 0; r < count; ++r) {
    if (!(rings[r].scale > 0.0F) || !is_finite(rings[r].scale) || !is_finite(rings[r].height_m) ||
        !finite2(rings[r].shift_m)) {
      return false;
    }
    if (r > 0 && !(rings[r].height_m > rings[r - 1].height_m)) return false;
  }
  return true;
}

void add_vertices(const Vector2<float>* corners, int n, const PartRing* rings, int ring_count,
                  ConvexPart& part) {
  for (int r = 0; r < ring_count; ++r) {
    for (int k = 0; k < n; ++k) {
      const Vector2<float> p = rings[r].scale * corners[k] + rings[r].shift_m;
      part.vertices.push_back(Vector3<float>(p.x(), p.y(), rings[r].height_m));
    }
  }
}

/// Bottom and top cap, then the sides ring by ring: side k of ring r has index 2 + r n + k.
void add_faces(int n, int ring_count, ConvexPart& part) {
  ConvexPart::Face bottom;
  ConvexPart::Face top;
  bottom.vertex_count = top.vertex_count = index8(n);
  for (int k = 0; k < n; ++k) {
    bottom.vertices[k] = index8(n - 1 - k);
    top.vertices[k] = index8((ring_count - 1) * n + k);
  }
  part.faces.push_back(bottom);
  part.faces.push_back(top);
  for (int r = 0; r + 1 < ring_count; ++r) {
    for (int k = 0; k < n; ++k) {
      const int next = (k + 1) % n;
      ConvexPart::Face side;
      side.vertex_count = 4;
      side.vertices[0] = index8(r * n + k);
      side.vertices[1] = index8(r * n + next);
      side.vertices[2] = index8((r + 1) * n + next);
      side.vertices[3] = index8((r + 1) * n + k);
      part.faces.push_back(side);
    }
  }
}

void add_edges(int n, int ring_count, ConvexPart& part) {
  const auto side = [n](int r, int k) { return index8(2 + r * n + (k + n) % n); };
  for (int r = 0; r < ring_count; ++r) {
    for (int k = 0; k < n; ++k) {
      const std::uint8_t below = r == 0 ? index8(0) : side(r - 1, k);
      const std::uint8_t above = r == ring_count - 1 ? index8(1) : side(r, k);
      part.edges.push_back({index8(r * n + k), index8(r * n + (k + 1) % n), below, above});
      if (r + 1 < ring_count) {
        part.edges.push_back(
            {index8(r * n + k), index8((r + 1) * n + k), side(r, k - 1), side(r, k)});
      }
    }
  }
}

/// Normals from the loops; false when a vertex lies outside of a face's plane or the part is flat.
bool orient(ConvexPart& part) {
  float size = 0.0F;
  for (const Vector3<float>& v : part.vertices) {
    const float distance = (v - part.vertices[0]).norm();
    if (distance > size) size = distance;
  }
  for (ConvexPart::Face& face : part.faces) {
    const Vector3<float>& p = part.vertices[face.vertices[0]];
    const Vector3<float> along = part.vertices[face.vertices[1]] - p;
    const Vector3<float> across = part.vertices[face.vertices[2]] - p;
    const Vector3<float> normal = along.cross(across);
    const float length = sqrt(normal.squaredNorm());
    if (!(length > 1e-6F * size * size)) return false;
    face.normal = normal / length;
    face.offset = face.normal.dot(p);
    for (const Vector3<float>& v : part.vertices) {
      if (face.normal.dot(v) > face.offset + 1e-4F * size) return false;
    }
  }
  return true;
}

struct Stone {
  float width;  // all in shares of the cairn's height
  float height;
  float x;
  float y;
  float turn_rad;
};

// From the ground up. Chosen by eye: the pile leans a little, so that its turning shows.
constexpr Stone kStones[] = {
    {0.45F, 0.22F, 0.00F, 0.00F, 0.20F},   {0.37F, 0.19F, 0.03F, -0.02F, 1.10F},
    {0.30F, 0.18F, -0.03F, 0.02F, 2.30F},  {0.24F, 0.16F, 0.02F, 0.03F, 0.70F},
    {0.17F, 0.14F, -0.01F, -0.01F, 1.80F}, {0.11F, 0.11F, 0.01F, 0.00F, 2.90F}};

// An irregular hexagon that is still convex.
constexpr float kCornerTurn[kMaxCorners] = {0.00F, 1.12F, 2.05F, 3.10F, 4.25F, 5.20F};
constexpr float kCornerReach[kMaxCorners] = {1.00F, 0.93F, 0.98F, 0.90F, 1.00F, 0.95F};

Status make_stone(const Stone& stone, float height_m, float base_m, ConvexPart& part) {
  Vector2<float> corners[kMaxCorners];
  for (int k = 0; k < kMaxCorners; ++k) {
    float s = 0.0F;
    float c = 1.0F;
    sin_cos(stone.turn_rad + kCornerTurn[k], s, c);
    corners[k] = height_m * stone.width * kCornerReach[k] * Vector2<float>(c, s);
  }
  const Vector2<float> centre(height_m * stone.x, height_m * stone.y);
  const float tall = height_m * stone.height;
  const PartRing rings[kMaxRings] = {{0.80F, base_m, centre},
                                     {1.00F, base_m + 0.45F * tall, centre},
                                     {0.72F, base_m + tall, centre}};
  return make_ring_part(corners, kMaxCorners, rings, kMaxRings, part);
}

}  // namespace

Status make_ring_part(const Vector2<float>* corners, int corner_count, const PartRing* rings,
                      int ring_count, ConvexPart& part) {
  if (corners == nullptr || rings == nullptr || corner_count < kMinCorners ||
      corner_count > kMaxCorners || ring_count < 2 || ring_count > kMaxRings ||
      !rings_are_valid(rings, ring_count)) {
    return Status::kInvalidArgument;
  }
  for (int k = 0; k < corner_count; ++k) {
    if (!finite2(corners[k])) return Status::kInvalidArgument;
  }
  ConvexPart built;
  add_vertices(corners, corner_count, rings, ring_count, built);
  add_faces(corner_count, ring_count, built);
  add_edges(corner_count, ring_count, built);
  if (!orient(built)) return Status::kInvalidArgument;
  part = built;
  return Status::kOk;
}

Status make_cairn(float height_m, VirtualObject& object) {
  if (!(height_m > 0.0F) || !is_finite(height_m)) return Status::kInvalidArgument;
  // Twice, so that a height beyond what float can shape leaves the object as it was.
  for (const bool store : {false, true}) {
    if (store) object.parts.clear();
    float base = 0.0F;
    for (const Stone& stone : kStones) {
      ConvexPart part;
      const Status status = make_stone(stone, height_m, base, part);
      if (!ok(status)) return status;
      if (store) object.parts.push_back(part);
      base += height_m * stone.height;
    }
  }
  return Status::kOk;
}

}  // namespace cairn
