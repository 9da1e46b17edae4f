#include "cairn/ar/fixed_object_drawing.hpp"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <memory>

#include <gtest/gtest.h>

#include "cairn/ar/augmenter.hpp"

#include "drawing_fixture.hpp"

namespace cairn {
namespace {

using test::GuardedImage;
using test::look_at;
using test::small_camera;

FixedCamera fixed_camera(const PinholeCamera<float>& camera) {
  FixedCamera fixed;
  EXPECT_EQ(fixed_of(camera, fixed), Status::kOk);
  return fixed;
}

/// Draws with floats and in integers; how many pixels differ by more than a quarter of the range,
/// and how many were drawn at all.
struct Difference {
  int far_off = 0;
  int drawn = 0;
  DrawReport report;
  DrawReport expected;
};
Difference compare(const VirtualObject& object, const PinholeCamera<float>& camera,
                   const Rigid<float>& T_world_object, const Rigid<float>& T_world_camera) {
  GuardedImage own(camera.width, camera.height);
  GuardedImage reference(camera.width, camera.height);
  Difference difference;
  const Status status =
      draw_object_in_integers(object, T_world_object, fixed_camera(camera), T_world_camera,
                              DrawStyle(), own.view(), difference.report);
  EXPECT_EQ(status, draw_object(object, T_world_object, camera, T_world_camera, DrawStyle(),
                                reference.view(), difference.expected));
  EXPECT_TRUE(own.guard_is_whole());
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      difference.drawn += reference.at(x, y) != 100 ? 1 : 0;
      difference.far_off += std::abs(own.at(x, y) - reference.at(x, y)) > 64 ? 1 : 0;
    }
  }
  return difference;
}

void expect_same_drawing(float k1, float least_m, float most_m) {
  auto object = std::make_unique<VirtualObject>();
  ASSERT_EQ(make_cairn(1.0F, *object), Status::kOk);
  std::mt19937 engine(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  int far_off = 0;
  int drawn = 0;
  int cut = 0;
  int cut_otherwise = 0;  // where stones touch, rounding decides
  for (int k = 0; k < 60; ++k) {
    Rigid<float> T_world_object;
    const float leaning = 0.1F * unit(engine);
    const float turned = 3.0F * unit(engine);
    T_world_object.rotation = rotation_exp(Vector3<float>(leaning, 0, turned));
    T_world_object.translation = {100.0F * unit(engine), 100.0F * unit(engine), 0.0F};
    const float away = least_m + (most_m - least_m) * 0.5F * (1.0F + unit(engine));
    const float bearing = 3.0F * unit(engine);
    const Vector3<float> from(away * std::cos(bearing), away * std::sin(bearing),
                              0.3F * away * (1.2F + unit(engine)));
    const Rigid<float> T_world_camera =
        look_at(T_world_object.translation + from,
                T_world_object.translation + Vector3<float>(0.3F * unit(engine), 0, 0.5F));
    const Difference difference =
        compare(*object, small_camera(k1), T_world_object, T_world_camera);
    EXPECT_EQ(difference.report.edges, difference.expected.edges) << k;
    cut += difference.expected.cut;
    cut_otherwise += std::abs(difference.report.cut - difference.expected.cut);
    far_off += difference.far_off;
    drawn += difference.drawn;
  }
  EXPECT_GT(drawn, 10000);
  EXPECT_LT(far_off, drawn / 200);
  EXPECT_LT(cut_otherwise, cut / 50) << cut;
}

TEST(FixedObjectDrawing, IsThatOfFloats) {
  expect_same_drawing(0.0F, 2.0F, 12.0F);
}

TEST(FixedObjectDrawing, IsThatOfFloatsNearTheCamera) {
  expect_same_drawing(0.0F, 0.9F, 1.5F);
}

/// Edges that begin beside the camera, more than 76 degrees off its axis, and end in the picture.
TEST(FixedObjectDrawing, ShowsWhatStandsBesideTheCamera) {
  auto object = std::make_unique<VirtualObject>();
  ASSERT_EQ(make_cairn(4.0F, *object), Status::kOk);
  int far_off = 0;
  int drawn = 0;
  for (int k = 0; k < 32; ++k) {
    const float bearing = 0.39F * static_cast<float>(k);
    const float aside = bearing + 1.2F + 0.05F * static_cast<float>(k % 16);
    const Vector3<float> eye(2.0F * std::cos(bearing), 2.0F * std::sin(bearing), 0.5F);
    const Vector3<float> ahead(std::cos(aside), std::sin(aside), 0.0F);
    const Difference difference =
        compare(*object, small_camera(0.0F), Rigid<float>(), look_at(eye, eye + ahead));
    far_off += difference.far_off;
    drawn += difference.drawn;
  }
  EXPECT_GT(drawn, 5000);
  EXPECT_LT(far_off, drawn / 50) << drawn;
}

TEST(FixedObjectDrawing, IsThatOfFloatsThroughALens) {
  expect_same_drawing(-0.12F, 2.0F, 12.0F);
}

TEST(FixedObjectDrawing, ALineHasTheWidthThatItHasWithFloats) {
  std::mt19937 engine(9);
  std::uniform_int_distribution<std::int32_t> at(-20000, 90000);
  std::uniform_int_distribution<int> width(100, 3000);
  int steps = 0;
  for (int k = 0; k < 2000; ++k) {
    GuardedImage own(320, 240);
    GuardedImage reference(320, 240);
    const LineQ8 line{at(engine), at(engine), at(engine), at(engine)};
    const int width_q8 = width(engine);
    static_cast<void>(draw_line_in_integers(own.view(), line, width_q8, 200));
    static_cast<void>(draw_line(reference.view(), line, width_q8, 200));
    ASSERT_TRUE(own.guard_is_whole());
    for (int y = 0; y < 240; ++y) {
      for (int x = 0; x < 320; ++x) {
        const int off = std::abs(own.at(x, y) - reference.at(x, y));
        ASSERT_LE(off, 1) << k;
        steps += off;
      }
    }
  }
  EXPECT_LT(steps, 20000);
}

TEST(FixedObjectDrawing, NothingIsDrawnBehindTheCameraOrTooFarAway) {
  auto object = std::make_unique<VirtualObject>();
  ASSERT_EQ(make_cairn(1.0F, *object), Status::kOk);
  GuardedImage image(320, 240);
  DrawReport report;
  const FixedCamera camera = fixed_camera(small_camera());
  const Rigid<float> view = look_at({5, 0, 1}, {0, 0, 0.5F});
  Rigid<float> behind;
  behind.translation = {10, 0, 0};
  EXPECT_EQ(
      draw_object_in_integers(*object, behind, camera, view, DrawStyle(), image.view(), report),
      Status::kOutOfView);
  Rigid<float> far;
  far.translation = {-600, 0, 0};
  EXPECT_EQ(draw_object_in_integers(*object, far, camera, view, DrawStyle(), image.view(), report),
            Status::kOutOfView);
  far.translation = {-3000, 0, 0};
  EXPECT_EQ(draw_object_in_integers(*object, far, camera, view, DrawStyle(), image.view(), report),
            Status::kOutOfView);
  Rigid<float> nowhere;
  nowhere.translation.x() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(
      draw_object_in_integers(*object, nowhere, camera, view, DrawStyle(), image.view(), report),
      Status::kOk);
  DrawStyle style;
  style.near_m = std::numeric_limits<float>::infinity();
  EXPECT_EQ(draw_object_in_integers(*object, {}, camera, view, style, image.view(), report),
            Status::kInvalidArgument);
  GuardedImage other(160, 120);
  EXPECT_EQ(draw_object_in_integers(*object, {}, camera, view, DrawStyle(), other.view(), report),
            Status::kInvalidArgument);
  EXPECT_EQ(image.changed(), 0);
  EXPECT_EQ(draw_object_in_integers(*object, {}, camera, view, DrawStyle(), image.view(), report),
            Status::kOk);
  EXPECT_GT(image.changed(), 100);
}

TEST(FixedObjectDrawing, AnAugmenterDrawsTheSameObjectsInIntegers) {
  auto augmenter = std::make_unique<Augmenter>();
  ASSERT_EQ(make_cairn(1.0F, augmenter->shape()), Status::kOk);
  augmenter->initialise(Augmenter::Parameters{});
  for (const float x : {0.0F, -2.0F, 20.0F}) {
    Rigid<float> place;
    place.translation.x() = x;
    ASSERT_EQ(augmenter->place(place), Status::kOk);
  }
  const Rigid<float> view = look_at({5, 0, 1}, {0, 0, 0.5F});
  GuardedImage own(320, 240);
  GuardedImage reference(320, 240);
  EXPECT_EQ(augmenter->draw_in_integers(small_camera(), view, own.view()), 2);
  EXPECT_EQ(augmenter->draw(small_camera(), view, reference.view()), 2);
  int far_off = 0;
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x)
      far_off += std::abs(own.at(x, y) - reference.at(x, y)) > 64 ? 1 : 0;
  }
  EXPECT_LT(far_off, reference.changed() / 100);
  PinholeCamera<float> fisheye = small_camera();
  fisheye.lens = Lens::kFisheye;
  EXPECT_EQ(augmenter->draw_in_integers(fisheye, view, own.view()), 0);
}

}  // namespace
}  // namespace cairn
