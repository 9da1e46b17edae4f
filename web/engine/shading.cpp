#include "shading.hpp"

#include <cstring>

#include "cairn/numeric/math.hpp"

namespace cairn_web {
namespace {

using cairn::ConvexPart;
using Vector = cairn::Vector3<float>;

constexpr float kFarthest = 1e30F;
constexpr float kNearest = 0.05F;
const Vector kToLight(-0.40F, -0.41F, 0.82F);  // object frame: from behind who placed it, unit
constexpr float kAmbient = 0.45F;
constexpr std::uint8_t kShadowOpacity = 90;
constexpr int kStones = 3;
constexpr float kStoneColours[kStones][3] = {{228, 190, 140}, {205, 168, 130}, {240, 210, 165}};

struct Colour {
  std::uint8_t channels[4];
};

/// A corner in the picture, px, with its depth.
struct Corner {
  float x, y, depth;
};

/// Twice the signed area of a, b and (x, y).
float area(const Corner& a, const Corner& b, float x, float y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

int limited(float value, int low, int high) {
  return cairn::round_to_int(
      cairn::clamp(value, static_cast<float>(low), static_cast<float>(high)));
}

struct Extent {
  int x0, y0, x1, y1;
};

Extent extent_of(const Corner& a, const Corner& b, const Corner& c, int width, int height) {
  const float left = a.x < b.x ? (a.x < c.x ? a.x : c.x) : (b.x < c.x ? b.x : c.x);
  const float right = a.x > b.x ? (a.x > c.x ? a.x : c.x) : (b.x > c.x ? b.x : c.x);
  const float top = a.y < b.y ? (a.y < c.y ? a.y : c.y) : (b.y < c.y ? b.y : c.y);
  const float bottom = a.y > b.y ? (a.y > c.y ? a.y : c.y) : (b.y > c.y ? b.y : c.y);
  return {limited(left - 1.0F, 0, width - 1), limited(top - 1.0F, 0, height - 1),
          limited(right + 1.0F, 0, width - 1), limited(bottom + 1.0F, 0, height - 1)};
}

/// Fills a triangle; `with_depth`: where nothing nearer was filled.
void fill_triangle(const Corner& a, const Corner& b, const Corner& c, const Colour& colour,
                   bool with_depth, int width, int height, const ShadedPicture& picture) {
  const float whole = area(a, b, c.x, c.y);
  if (whole == 0.0F) return;
  const Extent extent = extent_of(a, b, c, width, height);
  for (int y = extent.y0; y <= extent.y1; ++y) {
    for (int x = extent.x0; x <= extent.x1; ++x) {
      const auto fx = static_cast<float>(x);
      const auto fy = static_cast<float>(y);
      const float at_c = area(a, b, fx, fy) / whole;
      const float at_a = area(b, c, fx, fy) / whole;
      const float at_b = area(c, a, fx, fy) / whole;
      if (at_a < 0.0F || at_b < 0.0F || at_c < 0.0F) continue;
      const int at = y * width + x;
      if (with_depth) {
        const float depth = at_a * a.depth + at_b * b.depth + at_c * c.depth;
        if (!(depth < picture.depths[at])) continue;
        picture.depths[at] = depth;
      }
      for (int k = 0; k < 4; ++k) picture.colours[4 * at + k] = colour.channels[k];
    }
  }
}

bool see(const Vector& p_camera, const cairn::PinholeCamera<float>& camera, Corner& corner) {
  cairn::Vector2<float> pixel;
  if (!(p_camera.z() > kNearest) || !ok(camera.project(p_camera, pixel))) return false;
  corner = {pixel.x(), pixel.y(), p_camera.z()};
  return true;
}

/// Fills a face whose corners were moved to `p_object`.
void fill_face(const Vector* p_object, int count, const cairn::Rigid<float>& T_camera_object,
               const cairn::PinholeCamera<float>& camera, const Colour& colour, bool with_depth,
               const ShadedPicture& picture) {
  Corner corners[ConvexPart::kMaxFaceVertices];
  for (int i = 0; i < count; ++i) {
    if (!see(T_camera_object * p_object[i], camera, corners[i])) return;
  }
  for (int i = 2; i < count; ++i) {
    fill_triangle(corners[0], corners[i - 1], corners[i], colour, with_depth, camera.width,
                  camera.height, picture);
  }
}

Colour lit(const Vector& normal, int stone) {
  const float facing = normal.dot(kToLight);
  const float light = kAmbient + (1.0F - kAmbient) * (facing > 0.0F ? facing : 0.0F);
  Colour colour = {{0, 0, 0, 255}};
  for (int k = 0; k < 3; ++k) {
    colour.channels[k] =
        static_cast<std::uint8_t>(limited(light * kStoneColours[stone % kStones][k], 0, 255));
  }
  return colour;
}

}  // namespace

void clear(const ShadedPicture& picture, int pixels) {
  std::memset(picture.colours, 0, 4 * static_cast<std::size_t>(pixels));
  for (int i = 0; i < pixels; ++i) picture.depths[i] = kFarthest;
}

void fill_shadow(const cairn::VirtualObject& object, const cairn::Rigid<float>& T_camera_object,
                 const cairn::PinholeCamera<float>& camera, const ShadedPicture& picture) {
  const Vector eye = T_camera_object.inverse().translation;
  if (!(eye.z() > 0.0F)) return;  // the plane is seen from below
  for (const ConvexPart& part : object.parts) {
    for (const ConvexPart::Face& face : part.faces) {
      Vector corners[ConvexPart::kMaxFaceVertices];
      for (int i = 0; i < face.vertex_count; ++i) {
        const Vector& p = part.vertices[face.vertices[i]];
        corners[i] = p - kToLight * (p.z() / kToLight.z());
      }
      fill_face(corners, face.vertex_count, T_camera_object, camera, {{0, 0, 0, kShadowOpacity}},
                false, picture);
    }
  }
}

void fill_object(const cairn::VirtualObject& object, const cairn::Rigid<float>& T_camera_object,
                 const cairn::PinholeCamera<float>& camera, const ShadedPicture& picture) {
  const Vector eye = T_camera_object.inverse().translation;
  int stone = 0;
  for (const ConvexPart& part : object.parts) {
    for (const ConvexPart::Face& face : part.faces) {
      if (!(face.normal.dot(eye) > face.offset)) continue;
      Vector corners[ConvexPart::kMaxFaceVertices];
      for (int i = 0; i < face.vertex_count; ++i) corners[i] = part.vertices[face.vertices[i]];
      fill_face(corners, face.vertex_count, T_camera_object, camera, lit(face.normal, stone), true,
                picture);
    }
    ++stone;
  }
}

}  // namespace cairn_web
