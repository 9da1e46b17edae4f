#include "host_sim/render/shaded_object.hpp"

#include <gtest/gtest.h>

#include "drawing_fixture.hpp"

namespace cairn::host {
namespace {

PinholeCamera<double> camera_of(double k1 = 0) {
  PinholeCamera<double> camera;
  camera.fx = 250;
  camera.fy = 250;
  camera.cx = 160;
  camera.cy = 120;
  camera.k1 = k1;
  camera.width = 320;
  camera.height = 240;
  return camera;
}

Rigid<double> widen(const Rigid<float>& pose) {
  return {pose.rotation.cast<double>(), pose.translation.cast<double>()};
}

Rigid<double> seen_from(double x, double y, double z) {
  const Vector3<float> eye = Vector3<double>(x, y, z).cast<float>();
  return widen(test::look_at(eye, {0, 0, 0.5F}));
}

cv::Mat grey_frame() {
  return cv::Mat(240, 320, CV_8UC3, cv::Scalar(90, 90, 90));
}

int changed(const cv::Mat& frame, const cv::Rect& where = {0, 0, 320, 240}) {
  cv::Mat difference;
  cv::absdiff(frame, grey_frame(), difference);
  return cv::countNonZero(difference(where).clone().reshape(1) > 3) / 3;
}

VirtualObject cairn_object() {
  VirtualObject object;
  EXPECT_TRUE(ok(make_cairn(1.0F, object)));
  return object;
}

OccludingPolygon wall(double x, double y_left, double y_right) {
  return {{{x, y_left, -2}, {x, y_right, -2}, {x, y_right, 3}, {x, y_left, 3}}};
}

TEST(ShadedObject, IsDrawnWhereItStands) {
  const ShadedObject shaded(cairn_object(), camera_of());
  cv::Mat frame = grey_frame();
  shaded.draw(Rigid<double>(), seen_from(3, 0, 1), {}, frame);
  EXPECT_GT(changed(frame), 2500);
  EXPECT_EQ(changed(frame, {0, 0, 100, 240}), 0);
  cv::Mat behind = grey_frame();
  Rigid<double> away = seen_from(3, 0, 1);
  away.rotation = away.rotation * rotation_exp(Vector3<double>(0, 3.1, 0));
  shaded.draw(Rigid<double>(), away, {}, behind);
  EXPECT_EQ(changed(behind), 0);
}

TEST(ShadedObject, AWallInFrontHidesItAndAWallBehindDoesNot) {
  const ShadedObject shaded(cairn_object(), camera_of());
  cv::Mat free_view = grey_frame();
  shaded.draw(Rigid<double>(), seen_from(3, 0, 1), {}, free_view);
  cv::Mat hidden = grey_frame();
  shaded.draw(Rigid<double>(), seen_from(3, 0, 1), {wall(2, -4, 4)}, hidden);
  EXPECT_EQ(changed(hidden), 0);
  cv::Mat in_front = grey_frame();
  shaded.draw(Rigid<double>(), seen_from(3, 0, 1), {wall(-2, -8, 8)}, in_front);
  EXPECT_EQ(cv::norm(in_front, free_view, cv::NORM_INF), 0);
  cv::Mat half = grey_frame();
  shaded.draw(Rigid<double>(), seen_from(3, 0, 1), {wall(1, 0, 4)}, half);
  EXPECT_GT(changed(half), changed(free_view) / 5);
  EXPECT_LT(changed(half), changed(free_view) * 4 / 5);
}

TEST(ShadedObject, AWallThroughTheMiddleHidesTheFarHalf) {
  ShadedStyle style;
  style.shadow = 0;
  const ShadedObject shaded(cairn_object(), camera_of(), style);
  cv::Mat free_view = grey_frame();
  const Rigid<double> from_above = seen_from(1.2, 0, 3);
  shaded.draw(Rigid<double>(), from_above, {}, free_view);
  cv::Mat cut = grey_frame();
  shaded.draw(Rigid<double>(), from_above, {{{{0, -2, -1}, {0, 2, -1}, {0, 2, 2}, {0, -2, 2}}}},
              cut);
  EXPECT_LT(changed(cut), changed(free_view) - 100);
  EXPECT_GT(changed(cut), changed(free_view) / 3);
}

TEST(ShadedObject, SurvivesEveryPose) {
  const ShadedObject shaded(cairn_object(), camera_of(-0.2));
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 60; ++i) {
    Rigid<double> pose;
    pose.rotation = rotation_exp(Vector3<double>(3 * u(engine), 3 * u(engine), 3 * u(engine)));
    const double reach = i % 2 == 0 ? 0.5 : 4;
    pose.translation = Vector3<double>(reach * u(engine), reach * u(engine), reach * u(engine));
    cv::Mat frame = grey_frame();
    EXPECT_NO_THROW(shaded.draw(Rigid<double>(), pose, {wall(0.2, -1, 1)}, frame));
  }
  cv::Mat wrong(10, 10, CV_8UC3);
  EXPECT_THROW(shaded.draw(Rigid<double>(), Rigid<double>(), {}, wrong), std::invalid_argument);
}

}  // namespace
}  // namespace cairn::host
