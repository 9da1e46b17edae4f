#include "cairn/ar/object_drawing.hpp"

#include <cmath>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "drawing_fixture.hpp"

namespace cairn {
namespace {

using test::GuardedImage;
using test::look_at;
using test::small_camera;

/// Box of a size in m, standing on z = 0 about the origin.
Status make_box(const Vector3<float>& size_m, VirtualObject& object) {
  const Vector2<float> h(0.5F * size_m.x(), 0.5F * size_m.y());
  const Vector2<float> corners[4] = {
      {-h.x(), -h.y()}, {h.x(), -h.y()}, {h.x(), h.y()}, {-h.x(), h.y()}};
  PartRing rings[2];
  rings[1].height_m = size_m.z();
  ConvexPart part;
  const Status status = make_ring_part(corners, 4, rings, 2, part);
  if (!ok(status)) return status;
  object.parts.clear();
  object.parts.push_back(part);
  return Status::kOk;
}

Rigid<float> random_pose(std::mt19937& engine, float reach) {
  std::uniform_real_distribution<float> u(-1, 1);
  const auto draw = [&] {
    const float x = u(engine), y = u(engine), z = u(engine);
    return Vector3<float>(x, y, z);
  };
  Rigid<float> pose;
  pose.rotation = rotation_exp(Vector3<float>(3.0F * draw()));
  pose.translation = reach * draw();
  return pose;
}

Vector3<float> centre_of(const ConvexPart& part) {
  Vector3<float> sum = Vector3<float>::Zero();
  for (const auto& v : part.vertices) sum += v;
  return sum / static_cast<float>(part.vertices.size());
}

TEST(VirtualObject, PartsAreClosedConvexAndOutwards) {
  VirtualObject object;
  ASSERT_EQ(make_cairn(1.0F, object), Status::kOk);
  ASSERT_EQ(object.parts.size(), 6);
  float top = 0;
  for (const ConvexPart& part : object.parts) {
    EXPECT_EQ(part.vertices.size() - part.edges.size() + part.faces.size(), 2) << "Euler";
    const Vector3<float> centre = centre_of(part);
    for (const auto& face : part.faces) {
      EXPECT_LT(face.normal.dot(centre), face.offset);
      for (const auto& v : part.vertices) EXPECT_LE(face.normal.dot(v), face.offset + 1e-4F);
      for (int k = 0; k < face.vertex_count; ++k) {
        EXPECT_NEAR(face.normal.dot(part.vertices[face.vertices[k]]), face.offset, 1e-4);
      }
    }
    for (const auto& edge : part.edges) {  // an edge lies on both of its faces
      for (const int f : {edge.face_left, edge.face_right}) {
        for (const int v : {edge.a, edge.b}) {
          EXPECT_NEAR(part.faces[f].normal.dot(part.vertices[v]), part.faces[f].offset, 1e-4);
        }
      }
      EXPECT_NE(edge.face_left, edge.face_right);
    }
    for (const auto& v : part.vertices) top = std::max(top, v.z());
  }
  EXPECT_NEAR(top, 1.0F, 1e-5F);
  VirtualObject half;
  ASSERT_EQ(make_cairn(0.5F, half), Status::kOk);
  EXPECT_NEAR((half.parts[3].vertices[7] - 0.5F * object.parts[3].vertices[7]).norm(), 0, 1e-6);
}

TEST(VirtualObject, RefusesImpossibleShapes) {
  VirtualObject object;
  EXPECT_EQ(make_cairn(0, object), Status::kInvalidArgument);
  EXPECT_EQ(make_cairn(std::numeric_limits<float>::quiet_NaN(), object), Status::kInvalidArgument);
  EXPECT_EQ(make_box({1, 1, 0}, object), Status::kInvalidArgument);
  const Vector2<float> square[4] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
  const Vector2<float> clockwise[4] = {{-1, -1}, {-1, 1}, {1, 1}, {1, -1}};
  PartRing rings[3];
  rings[1].height_m = 1;
  rings[2].height_m = 2;
  ConvexPart part;
  EXPECT_EQ(make_ring_part(square, 4, rings, 2, part), Status::kOk);
  EXPECT_EQ(make_ring_part(clockwise, 4, rings, 2, part), Status::kInvalidArgument);
  rings[1].scale = 0.5F;  // a waist
  EXPECT_EQ(make_ring_part(square, 4, rings, 3, part), Status::kInvalidArgument);
  rings[1].scale = 1;
  rings[1].height_m = 0;
  EXPECT_EQ(make_ring_part(square, 4, rings, 2, part), Status::kInvalidArgument);
  EXPECT_EQ(make_ring_part(square, 7, rings, 2, part), Status::kInvalidArgument);
}

TEST(DrawObject, NeverLeavesTheImageWhateverThePose) {
  VirtualObject object;
  ASSERT_TRUE(ok(make_cairn(1.0F, object)));
  std::mt19937 engine(1);
  GuardedImage image(320, 240);
  int drawn = 0;
  for (int i = 0; i < 1500; ++i) {
    const auto camera = small_camera(i % 2 == 0 ? 0.0F : -0.2F);
    const float reach = i % 3 == 0 ? 0.6F : (i % 3 == 1 ? 3.0F : 300.0F);  // also inside the stones
    DrawReport report;
    const Status status = draw_object(object, Rigid<float>(), camera, random_pose(engine, reach),
                                      DrawStyle(), image.view(), report);
    ASSERT_TRUE(status == Status::kOk || status == Status::kOutOfView);
    drawn += ok(status) ? 1 : 0;
  }
  EXPECT_GT(drawn, 200);
  EXPECT_TRUE(image.guard_is_whole());
}

TEST(DrawObject, ABoxShowsOnlyTheEdgesOfFacesThatLookAtTheCamera) {
  VirtualObject box;
  ASSERT_TRUE(ok(make_box({1, 1, 1}, box)));
  const auto camera = small_camera();
  const auto edges = [&](const Vector3<float>& eye) {
    GuardedImage image(320, 240);
    DrawReport report;
    EXPECT_EQ(draw_object(box, Rigid<float>(), camera, look_at(eye, {0, 0, 0.5F}), DrawStyle(),
                          image.view(), report),
              Status::kOk);
    return report.edges;
  };
  EXPECT_EQ(edges({4, 0, 0.5F}), 4);  // one face
  EXPECT_EQ(edges({4, 4, 0.5F}), 7);  // two
  EXPECT_EQ(edges({4, 4, 3}), 9);     // three
}

VirtualObject two_boxes(float half_depth_between) {
  VirtualObject near_box;
  VirtualObject far_box;
  EXPECT_TRUE(ok(make_box({0.5F, 1, 1}, near_box)));
  EXPECT_TRUE(ok(make_box({0.5F, 0.6F, 0.6F}, far_box)));
  VirtualObject both;
  for (auto* source : {&near_box, &far_box}) {
    ConvexPart part = source->parts[0];
    const float x = source == &near_box ? half_depth_between : -half_depth_between;
    const float z = source == &near_box ? 0.0F : 0.2F;
    for (auto& v : part.vertices) v += Vector3<float>(x, 0, z);
    for (auto& face : part.faces) face.offset += face.normal.dot(Vector3<float>(x, 0, z));
    both.parts.push_back(part);
  }
  return both;
}

TEST(DrawObject, APartBehindAnotherIsNotDrawn) {
  const VirtualObject both = two_boxes(1);
  VirtualObject front;
  front.parts.push_back(both.parts[0]);
  const auto camera = small_camera();
  const auto pose = look_at({4, 0, 0.5F}, {0, 0, 0.5F});
  GuardedImage with(320, 240), without(320, 240);
  DrawReport report;
  ASSERT_TRUE(
      ok(draw_object(both, Rigid<float>(), camera, pose, DrawStyle(), with.view(), report)));
  EXPECT_EQ(report.cut, 4);
  ASSERT_TRUE(
      ok(draw_object(front, Rigid<float>(), camera, pose, DrawStyle(), without.view(), report)));
  EXPECT_EQ(with.bytes(), without.bytes());
  // From the other side the small box stands in front of the large one and is seen.
  const auto back = look_at({-8, 0, 0.5F}, {0, 0, 0.5F});
  GuardedImage other(320, 240);
  ASSERT_TRUE(
      ok(draw_object(both, Rigid<float>(), camera, back, DrawStyle(), other.view(), report)));
  EXPECT_EQ(report.edges, 8);
  EXPECT_EQ(report.cut, 0);
}

/// Whether the segment from `eye` to `p` passes through a part (p's own surface excluded).
bool is_hidden(const VirtualObject& object, const Vector3<float>& eye, const Vector3<float>& p) {
  for (const ConvexPart& part : object.parts) {
    double enter = 0;
    double leave = 1 - 2e-3;
    for (const auto& face : part.faces) {
      const double at_eye = double{face.normal.dot(eye)} - double{face.offset};
      const double at_p = double{face.normal.dot(p)} - double{face.offset};
      if (at_eye > 0 && at_p > 0) {
        enter = 2;
        break;
      }
      if (at_eye <= 0 && at_p <= 0) continue;
      const double t = at_eye / (at_eye - at_p);
      if (at_eye > 0) {
        enter = std::max(enter, t);
      } else {
        leave = std::min(leave, t);
      }
    }
    if (leave - enter > 4e-3) return true;
  }
  return false;
}

TEST(DrawObject, DrawsWhatRayCastingSeesAndNothingElse) {
  VirtualObject object;
  ASSERT_TRUE(ok(make_cairn(1.0F, object)));
  PinholeCamera<float> camera = small_camera();
  DrawStyle style;
  style.halo_width_q8 = 0;
  style.line_width_q8 = 256;
  std::mt19937 engine(5);
  std::uniform_real_distribution<float> turn(0, 6.28F), height(-0.5F, 2.5F), distance(1.2F, 3);
  int wrong = 0;
  int checked = 0;
  for (int view = 0; view < 25; ++view) {
    const float angle = turn(engine);
    const float d = distance(engine);
    const Vector3<float> eye(d * std::cos(angle), d * std::sin(angle), height(engine));
    const auto pose = look_at(eye, {0, 0, 0.5F});
    GuardedImage image(320, 240, 0);
    DrawReport report;
    ASSERT_TRUE(ok(draw_object(object, Rigid<float>(), camera, pose, style, image.view(), report)));
    std::vector<std::uint8_t> expected(320 * 240, 0);  // 1: a visible edge is within 2 px
    for (const ConvexPart& part : object.parts) {
      for (const auto& edge : part.edges) {
        const Vector3<float>& a = part.vertices[edge.a];
        const Vector3<float>& b = part.vertices[edge.b];
        for (int k = 0; k <= 100; ++k) {
          const Vector3<float> p = a + static_cast<float>(k) / 100 * (b - a);
          Vector2<float> pixel;
          if (!ok(camera.project(pose.inverse() * p, pixel)) || !camera.contains(pixel, 3))
            continue;
          if (is_hidden(object, eye, p)) continue;
          const int x = static_cast<int>(std::lround(pixel.x()));
          const int y = static_cast<int>(std::lround(pixel.y()));
          int brightest = 0;
          for (int dy = -2; dy <= 2; ++dy) {
            for (int dx = -2; dx <= 2; ++dx) {
              brightest = std::max<int>(brightest, image.at(x + dx, y + dy));
              expected[static_cast<std::size_t>(y + dy) * 320 + static_cast<std::size_t>(x + dx)] =
                  1;
            }
          }
          ++checked;
          wrong += brightest < 60 ? 1 : 0;  // seen, but not drawn
        }
      }
    }
    for (int y = 3; y < 237; ++y) {
      for (int x = 3; x < 317; ++x) {  // drawn, but not seen
        const std::size_t at = static_cast<std::size_t>(y) * 320 + static_cast<std::size_t>(x);
        wrong += image.at(x, y) > 100 && expected[at] == 0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(checked, 20000);
  // Grazing edges: the two tolerances differ where stones touch.
  EXPECT_LE(wrong, checked / 500);
}

TEST(DrawObject, FollowsTheLensInNoMorePiecesThanItBends) {
  VirtualObject box;
  ASSERT_TRUE(ok(make_box({1, 1, 1}, box)));
  const auto camera = small_camera(-0.3F);
  DrawStyle style;
  style.halo_width_q8 = 0;
  const auto draw = [&](const Vector3<float>& eye, DrawReport& report) {
    GuardedImage image(320, 240);
    const auto pose = look_at(eye, {0, 0, 0.5F});
    EXPECT_TRUE(ok(draw_object(box, Rigid<float>(), camera, pose, style, image.view(), report)));
    const ConvexPart& part = box.parts[0];
    for (const auto& edge : part.edges) {
      const auto front = [&](int f) {
        return part.faces[f].normal.dot(pose.translation) > part.faces[f].offset;
      };
      if (!front(edge.face_left) && !front(edge.face_right)) continue;
      for (int k = 0; k <= 100; ++k) {
        const float t = static_cast<float>(k) / 100.0F;
        const Vector3<float> p =
            part.vertices[edge.a] + t * (part.vertices[edge.b] - part.vertices[edge.a]);
        Vector2<float> pixel;
        if (!ok(camera.project(pose.inverse() * p, pixel)) || !camera.contains(pixel, 3)) continue;
        EXPECT_GT(image.at(static_cast<int>(std::lround(pixel.x())),
                           static_cast<int>(std::lround(pixel.y()))),
                  190)
            << k;
      }
    }
  };
  DrawReport near;
  draw({1.1F, 0.9F, 0.9F}, near);
  EXPECT_GT(near.segments, 20);
  DrawReport far;
  draw({8, 6, 3}, far);
  EXPECT_EQ(far.segments, far.edges);
}

TEST(DrawObject, TheWorkBudgetHoldsAndWhatIsLeftOutIsCounted) {
  VirtualObject object;
  ASSERT_TRUE(ok(make_cairn(1.0F, object)));
  GuardedImage image(320, 240);
  DrawStyle style;
  DrawReport report;
  const auto pose = look_at({1.5F, 1, 1}, {0, 0, 0.5F});
  ASSERT_TRUE(
      ok(draw_object(object, Rigid<float>(), small_camera(), pose, style, image.view(), report)));
  EXPECT_EQ(report.left_out, 0);
  style.max_pixels = 1000;
  const int line_pixels = 400 * 8;  // a diagonal of the image with its halo
  ASSERT_TRUE(
      ok(draw_object(object, Rigid<float>(), small_camera(), pose, style, image.view(), report)));
  EXPECT_GT(report.left_out, 100);
  EXPECT_LE(report.pixels, 2 * (style.max_pixels + line_pixels));
}

TEST(DrawObject, IsTheSameToTheBitEveryTime) {
  VirtualObject object;
  ASSERT_TRUE(ok(make_cairn(1.0F, object)));
  GuardedImage first(320, 240), second(320, 240);
  const auto pose = look_at({1.5F, 1, 1}, {0, 0, 0.5F});
  DrawReport report;
  for (auto* image : {&first, &second}) {
    ASSERT_TRUE(ok(draw_object(object, Rigid<float>(), small_camera(-0.1F), pose, DrawStyle(),
                               image->view(), report)));
  }
  EXPECT_EQ(first.bytes(), second.bytes());
}

TEST(DrawObject, RefusesImpossibleInputAndLeavesTheImage) {
  VirtualObject object;
  ASSERT_TRUE(ok(make_cairn(1.0F, object)));
  GuardedImage image(320, 240);
  DrawReport report;
  auto camera = small_camera();
  Rigid<float> pose;
  pose.translation.x() = std::numeric_limits<float>::infinity();
  EXPECT_EQ(draw_object(object, Rigid<float>(), camera, pose, DrawStyle(), image.view(), report),
            Status::kNonFiniteInput);
  EXPECT_EQ(draw_object(object, Rigid<float>(), camera, look_at({3, 0, 0}, {6, 0, 0}), DrawStyle(),
                        image.view(), report),
            Status::kOutOfView);
  camera.width = 640;
  EXPECT_EQ(draw_object(object, Rigid<float>(), camera, Rigid<float>(), DrawStyle(), image.view(),
                        report),
            Status::kInvalidArgument);
  EXPECT_EQ(image.changed(), 0);
}

}  // namespace
}  // namespace cairn
