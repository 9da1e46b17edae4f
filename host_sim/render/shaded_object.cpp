#include "host_sim/render/shaded_object.hpp"

#include <algorithm>
#include <stdexcept>

#include <opencv2/imgproc.hpp>

namespace cairn::host {
namespace {

using Polygon = std::vector<Vector3<double>>;

constexpr double kNear_m = 0.1;
constexpr int kEdgePieces = 4;    // an edge is bent by the lens
constexpr int kSubpixelBits = 4;  // of fillPoly's coordinates
constexpr int kShadowBlur_px = 5;

/// The part of a convex polygon where normal . p >= offset (Sutherland and Hodgman).
Polygon clip(const Polygon& polygon, const Vector3<double>& normal, double offset) {
  Polygon result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector3<double>& a = polygon[i];
    const Vector3<double>& b = polygon[(i + 1) % polygon.size()];
    const double at_a = normal.dot(a) - offset;
    const double at_b = normal.dot(b) - offset;
    if (at_a >= 0) result.push_back(a);
    if ((at_a >= 0) != (at_b >= 0)) result.push_back(a + at_a / (at_a - at_b) * (b - a));
  }
  return result;
}

Vector3<double> widen(const Vector3<float>& v) {
  return v.cast<double>();
}

/// A plane of `a` beyond which all of `b` lies, if there is one: +1 when `eye` is on b's side, -1
/// when on a's, 0 without such a plane.
int side_of_eye(const ConvexPart& a, const ConvexPart& b, const Vector3<double>& eye) {
  for (const auto& face : a.faces) {
    const bool separates = std::all_of(b.vertices.begin(), b.vertices.end(), [&](const auto& v) {
      return face.normal.dot(v) >= face.offset - 1e-4F;
    });
    if (separates) return widen(face.normal).dot(eye) > double{face.offset} ? 1 : -1;
  }
  return 0;
}

/// Whether `a` may hide something of `b`.
bool is_in_front(const ConvexPart& a, const ConvexPart& b, const Vector3<double>& eye) {
  const int by_a = side_of_eye(a, b, eye);
  if (by_a != 0) return by_a < 0;
  return side_of_eye(b, a, eye) > 0;
}

Polygon transformed(const Rigid<double>& T, const Polygon& polygon) {
  Polygon result;
  for (const auto& p : polygon) result.push_back(T * p);
  return result;
}

}  // namespace

/// What is painted, at `scale` samples a pixel, before it is blended into the frame.
struct ShadedObject::Layer {
  Layer(const cv::Rect& rect, int samples)
      : region(rect),
        scale(samples),
        colour(rect.height * samples, rect.width * samples, CV_8UC3, cv::Scalar::all(0)),
        alpha(colour.size(), CV_8UC1, cv::Scalar(0)) {}

  cv::Rect region;
  int scale;
  cv::Mat colour;
  cv::Mat alpha;

  void blend_into(cv::Mat& frame) const {
    cv::Mat small_colour;
    cv::Mat small_alpha;
    cv::resize(colour, small_colour, region.size(), 0, 0, cv::INTER_AREA);
    cv::resize(alpha, small_alpha, region.size(), 0, 0, cv::INTER_AREA);
    for (int y = 0; y < region.height; ++y) {
      cv::Vec3b* out = frame.ptr<cv::Vec3b>(region.y + y) + region.x;
      const cv::Vec3b* in = small_colour.ptr<cv::Vec3b>(y);
      const std::uint8_t* a = small_alpha.ptr<std::uint8_t>(y);
      for (int x = 0; x < region.width; ++x) {
        for (int c = 0; c < 3; ++c) {  // the colour is already weighted by the coverage
          out[x][c] = cv::saturate_cast<std::uint8_t>(in[x][c] + out[x][c] * (255 - a[x]) / 255);
        }
      }
    }
  }
};

ShadedObject::ShadedObject(const VirtualObject& object, const PinholeCamera<double>& camera,
                           const ShadedStyle& style)
    : object_(object), camera_(camera), style_(style) {
  style_.towards_light.normalize();
}

std::vector<int> ShadedObject::far_to_near(const Vector3<double>& eye) const {
  std::vector<int> waiting;
  for (int p = 0; p < object_.parts.size(); ++p) waiting.push_back(p);
  std::vector<int> order;
  while (!waiting.empty()) {
    // Next: a part that is in front of none of those that still wait.
    auto next = std::find_if(waiting.begin(), waiting.end(), [&](int p) {
      return std::none_of(waiting.begin(), waiting.end(), [&](int q) {
        return q != p && is_in_front(object_.parts[p], object_.parts[q], eye);
      });
    });
    if (next == waiting.end()) next = waiting.begin();
    order.push_back(*next);
    waiting.erase(next);
  }
  return order;
}

std::vector<cv::Point> ShadedObject::outline(const Polygon& polygon, const Layer& layer) const {
  const Polygon visible = clip(polygon, Vector3<double>(0, 0, 1), kNear_m);
  std::vector<cv::Point> points;
  const int pieces = camera_.has_distortion() ? kEdgePieces : 1;
  for (std::size_t i = 0; i < visible.size(); ++i) {
    const Vector3<double>& a = visible[i];
    const Vector3<double>& b = visible[(i + 1) % visible.size()];
    for (int k = 0; k < pieces; ++k) {
      Vector2<double> pixel;
      if (!ok(camera_.project(a + static_cast<double>(k) / pieces * (b - a), pixel))) continue;
      // Pixel centres are whole numbers; in the layer a pixel is `scale` samples wide.
      const double u = (pixel.x() + 0.5 - layer.region.x) * layer.scale - 0.5;
      const double v = (pixel.y() + 0.5 - layer.region.y) * layer.scale - 0.5;
      const double limit = 1e5;
      points.emplace_back(cvRound(std::clamp(u, -limit, limit) * (1 << kSubpixelBits)),
                          cvRound(std::clamp(v, -limit, limit) * (1 << kSubpixelBits)));
    }
  }
  return points;
}

void ShadedObject::paint(const Polygon& polygon, const std::vector<Polygon>& occluders,
                         const cv::Scalar& colour, Layer& layer) const {
  const std::vector<cv::Point> points = outline(polygon, layer);
  if (points.size() < 3) return;
  cv::Rect box = cv::boundingRect(points);
  box = {(box.x >> kSubpixelBits) - 1, (box.y >> kSubpixelBits) - 1,
         (box.width >> kSubpixelBits) + 4, (box.height >> kSubpixelBits) + 4};
  box &= cv::Rect(0, 0, layer.alpha.cols, layer.alpha.rows);
  if (box.empty()) return;
  const auto fill = [&](const std::vector<cv::Point>& shape) {
    cv::Mat mask(box.size(), CV_8UC1, cv::Scalar(0));
    std::vector<cv::Point> shifted = shape;
    for (cv::Point& p : shifted) p -= cv::Point(box.x << kSubpixelBits, box.y << kSubpixelBits);
    if (shifted.size() >= 3) {
      cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{shifted}, 255, cv::LINE_8,
                   kSubpixelBits);
    }
    return mask;
  };
  cv::Mat mask = fill(points);
  for (const Polygon& occluder : occluders) {
    // Behind: on the other side of the occluder's plane than the camera, which is the origin.
    Vector3<double> normal = Vector3<double>(occluder[1] - occluder[0])
                                 .cross(Vector3<double>(occluder[2] - occluder[0]));
    double offset = normal.dot(occluder[0]);
    if (offset < 0) {
      normal = -normal;
      offset = -offset;
    }
    const Polygon behind = clip(polygon, normal, offset);
    if (behind.size() < 3) continue;
    cv::Mat hidden = fill(outline(behind, layer));
    hidden &= fill(outline(occluder, layer));
    mask.setTo(0, hidden);
  }
  layer.colour(box).setTo(colour, mask);
  layer.alpha(box).setTo(255, mask);
}

cv::Rect ShadedObject::region(const Rigid<double>& T_camera_object) const {
  // Shadows may fall well beside the object: take a box around it that holds both.
  std::vector<cv::Point2f> points;
  bool crosses_near = false;
  for (const ConvexPart& part : object_.parts) {
    for (const auto& vertex : part.vertices) {
      const Vector3<double> v = widen(vertex);
      const double reach = v.z() / style_.towards_light.z();
      for (const Vector3<double>& p : {v, Vector3<double>(v - reach * style_.towards_light)}) {
        Vector2<double> pixel;
        const Vector3<double> p_camera = T_camera_object * p;
        if (p_camera.z() < kNear_m || !ok(camera_.project(p_camera, pixel))) {
          crosses_near = true;
          continue;
        }
        points.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
      }
    }
  }
  const cv::Rect whole(0, 0, camera_.width, camera_.height);
  if (points.empty()) return {};
  if (crosses_near) return whole;
  cv::Rect2f box(points[0], cv::Size2f(0, 0));
  for (const cv::Point2f& p : points) box |= cv::Rect2f(p, cv::Size2f(1, 1));
  const double margin = 2 * kShadowBlur_px;
  const cv::Rect2d clipped =
      cv::Rect2d(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
      cv::Rect2d(0, 0, camera_.width, camera_.height);
  return cv::Rect(
             cv::Point(cvFloor(clipped.x), cvFloor(clipped.y)),
             cv::Point(cvCeil(clipped.x + clipped.width), cvCeil(clipped.y + clipped.height))) &
         whole;
}

void ShadedObject::paint_shadow(const Rigid<double>& T_camera_object,
                                const std::vector<Polygon>& occluders, cv::Mat& frame) const {
  const Vector3<double> eye = T_camera_object.inverse().translation;
  if (style_.shadow <= 0 || style_.towards_light.z() < 0.1 || eye.z() <= 0) return;
  Layer layer(region(T_camera_object), style_.supersampling);
  for (const ConvexPart& part : object_.parts) {
    std::vector<cv::Point2f> on_ground;
    for (const auto& vertex : part.vertices) {
      const Vector3<double> v = widen(vertex);
      const Vector3<double> p = v - v.z() / style_.towards_light.z() * style_.towards_light;
      on_ground.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
    }
    std::vector<cv::Point2f> hull;
    cv::convexHull(on_ground, hull);
    Polygon polygon;
    for (const auto& p : hull) polygon.emplace_back(double{p.x}, double{p.y}, 0.0);
    paint(transformed(T_camera_object, polygon), occluders, cv::Scalar::all(0), layer);
  }
  cv::Mat shade;
  cv::resize(layer.alpha, shade, layer.region.size(), 0, 0, cv::INTER_AREA);
  cv::GaussianBlur(shade, shade, {kShadowBlur_px, kShadowBlur_px}, 0);
  for (int y = 0; y < layer.region.height; ++y) {
    cv::Vec3b* out = frame.ptr<cv::Vec3b>(layer.region.y + y) + layer.region.x;
    const std::uint8_t* s = shade.ptr<std::uint8_t>(y);
    for (int x = 0; x < layer.region.width; ++x) {
      const double light = 1.0 - style_.shadow * s[x] / 255.0;
      for (int c = 0; c < 3; ++c) out[x][c] = cv::saturate_cast<std::uint8_t>(out[x][c] * light);
    }
  }
}

void ShadedObject::draw(const Rigid<double>& T_world_object, const Rigid<double>& T_world_camera,
                        const std::vector<OccludingPolygon>& occluders, cv::Mat& frame) const {
  if (frame.type() != CV_8UC3 || frame.cols != camera_.width || frame.rows != camera_.height) {
    throw std::invalid_argument(
        "a frame for the shaded object must be CV_8UC3 of the camera's size");
  }
  const Rigid<double> T_camera_world = T_world_camera.inverse();
  const Rigid<double> T_camera_object = T_camera_world * T_world_object;
  const cv::Rect where = region(T_camera_object);
  if (where.empty()) return;
  std::vector<Polygon> in_camera;
  for (const OccludingPolygon& o : occluders) {
    if (o.corners.size() >= 3) in_camera.push_back(transformed(T_camera_world, o.corners));
  }
  paint_shadow(T_camera_object, in_camera, frame);
  const Vector3<double> eye = T_camera_object.inverse().translation;
  Layer layer(where, style_.supersampling);
  for (const int p : far_to_near(eye)) {
    const ConvexPart& part = object_.parts[p];
    for (const auto& face : part.faces) {
      const Vector3<double> normal = widen(face.normal);
      if (normal.dot(eye) <= double{face.offset}) continue;
      Polygon polygon;
      for (int k = 0; k < face.vertex_count; ++k) {
        polygon.push_back(T_camera_object * widen(part.vertices[face.vertices[k]]));
      }
      const double facing = std::max(0.0, normal.dot(style_.towards_light));
      paint(polygon, in_camera, style_.colour * (style_.ambient + (1 - style_.ambient) * facing),
            layer);
    }
  }
  layer.blend_into(frame);
}

}  // namespace cairn::host
