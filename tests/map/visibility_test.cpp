#include "cairn/map/visibility.hpp"

#include <gtest/gtest.h>

#include "map_fixture.hpp"
#include "vga_camera.hpp"

namespace cairn {
namespace {

using test::LandmarkMaker;
using test::SmallConfig;
using test::vga_camera;

LibraryLandmark<float> seen_from_origin(LandmarkMaker& maker, LandmarkId id,
                                        const Vector3<float>& p_map) {
  auto l = maker.landmark(id);
  l.p_map = p_map;
  l.views[0].focal_px = 500;
  l.views[0].pose = FreakPose{0, 4};
  l.views[0].T_map_reference = Rigid<float>();
  return l;
}

TEST(PredictView, TheReferencePoseGivesTheReferenceBack) {
  LandmarkMaker maker(1);
  const auto camera = vga_camera<float>();
  for (int i = 0; i < 50; ++i) {
    auto l = seen_from_origin(maker, 1, Vector3<float>(0.5F, -0.4F, 2.0F));
    l.views[0].pose.orientation_bin = static_cast<std::uint8_t>(5 * i);
    ViewPrediction<float> p;
    ASSERT_TRUE(ok(predict_view(camera, Rigid<float>(), l.p_map, l.views[0], p)));
    EXPECT_EQ(p.pose.orientation_bin, l.views[0].pose.orientation_bin);
    EXPECT_EQ(p.pose.scale_index, 4);
    EXPECT_NEAR(p.scale_ratio, 1, 1e-6);
    EXPECT_NEAR(p.cosine, 1, 1e-6);
  }
}

TEST(PredictView, RollOfTheCameraTurnsThePatternBack) {
  LandmarkMaker maker(2);
  const auto camera = vga_camera<float>();
  for (int bin = 0; bin < 256; bin += 8) {
    const auto l = seen_from_origin(maker, 1, Vector3<float>(0.02F, 0.01F, 3.0F));
    Rigid<float> pose;  // camera turned clockwise: the image turns anticlockwise
    pose.rotation =
        rotation_exp(Vector3<float>(0, 0, kTwoPi<float> / 256 * static_cast<float>(bin)));
    ViewPrediction<float> p;
    ASSERT_TRUE(ok(predict_view(camera, pose, l.p_map, l.views[0], p)));
    EXPECT_EQ(p.pose.orientation_bin, (256 - bin) % 256);
  }
}

TEST(PredictView, ComingNearerRaisesTheScale) {
  LandmarkMaker maker(3);
  const auto camera = vga_camera<float>();
  const auto l = seen_from_origin(maker, 1, Vector3<float>(0, 0, 4));
  Rigid<float> pose;
  pose.translation.z() = 2;
  ViewPrediction<float> p;
  ASSERT_TRUE(ok(predict_view(camera, pose, l.p_map, l.views[0], p)));
  EXPECT_NEAR(p.scale_ratio, 2, 1e-5);
  EXPECT_EQ(p.pose.scale_index, 4 + 16);
  pose.translation.z() = 3.9F;
  ASSERT_TRUE(ok(predict_view(camera, pose, l.p_map, l.views[0], p)));
  EXPECT_EQ(p.pose.scale_index, 24);
  pose.translation.z() = 5;
  EXPECT_EQ(predict_view(camera, pose, l.p_map, l.views[0], p), Status::kOutOfView);
}

/// A map from elsewhere may hold any finite number.
TEST(PredictView, WhatOverflowsIsOutOfView) {
  LandmarkMaker maker(3);
  const auto camera = vga_camera<float>();
  auto l = seen_from_origin(maker, 1, Vector3<float>(0, 0, 4));
  l.p_map = Vector3<float>(1e38F, 0, 2e38F);
  l.views[0].focal_px = 1e-3F;
  ViewPrediction<float> p;
  p.pixel.x() = -7.0F;
  EXPECT_EQ(predict_view(camera, Rigid<float>(), l.p_map, l.views[0], p), Status::kOutOfView);
  l.p_map = Vector3<float>(0, 0, 4);
  l.views[0].focal_px = 1e-38F;
  EXPECT_EQ(predict_view(camera, Rigid<float>(), l.p_map, l.views[0], p), Status::kOutOfView);
  EXPECT_EQ(p.pixel.x(), -7.0F);
}

TEST(FindVisible, GivesWhatAPoseShouldSeeHighestScoreFirst) {
  LandmarkMaker maker(4);
  const auto camera = vga_camera<float>();
  MapLibrary<SmallConfig> library;
  Health health;
  const auto add = [&](LandmarkId id, const Vector3<float>& p, int sightings) {
    auto l = seen_from_origin(maker, id, p);
    l.covariance.setZero();
    l.searches = 30;
    l.sightings = static_cast<std::uint16_t>(sightings);
    ASSERT_TRUE(ok(library.insert(l, health)));
  };
  add(1, {0.0F, 0.0F, 3}, 5);
  add(2, {0.5F, 0.0F, 3}, 9);
  add(3, {-0.5F, 0.0F, 3}, 5);
  add(4, {9.0F, 0.0F, 3}, 30);   // outside the image
  add(5, {0.0F, 0.0F, -3}, 30);  // behind
  add(6, {0.3F, 0.3F, 3}, 14);
  VisibleLandmark<float> out[8];
  const VisibilityOptions<float> options;
  ASSERT_EQ(find_visible(library, camera, Rigid<float>(), options, {}, out, 8), 4);
  EXPECT_EQ(out[0].id, 6U);
  EXPECT_EQ(out[1].id, 2U);
  EXPECT_EQ(out[2].id, 1U);  // a tie with 3
  EXPECT_EQ(out[3].id, 3U);
  EXPECT_NEAR(out[1].prediction.pixel.x(), 320 + 500 * 0.5 / 3, 1e-3);

  ASSERT_EQ(find_visible(library, camera, Rigid<float>(), options, {}, out, 2), 2);
  EXPECT_EQ(out[0].id, 6U);
  EXPECT_EQ(out[1].id, 2U);

  const LandmarkId tracked[] = {6, 1};
  ASSERT_EQ(find_visible(library, camera, Rigid<float>(), options, {tracked, 2}, out, 8), 2);
  EXPECT_EQ(out[0].id, 2U);
  EXPECT_EQ(out[1].id, 3U);
}

TEST(FindVisible, LeavesOutViewsThatCannotBeMatched) {
  LandmarkMaker maker(5);
  const auto camera = vga_camera<float>();
  MapLibrary<SmallConfig> library;
  Health health;
  ASSERT_TRUE(ok(library.insert(seen_from_origin(maker, 1, {0, 0, 3}), health)));
  VisibleLandmark<float> out[2];
  const VisibilityOptions<float> options;
  Rigid<float> pose;
  pose.translation.z() = -4;  // from 7 m instead of 3 m: too small
  EXPECT_EQ(find_visible(library, camera, pose, options, {}, out, 2), 0);
  // From the side, looking at it: 90 degrees from the reference view.
  pose.translation = Vector3<float>(3, 0, 3);
  pose.rotation = rotation_exp(Vector3<float>(0, -kHalfPi<float>, 0));
  ViewPrediction<float> p;
  ASSERT_TRUE(ok(predict_view(camera, pose, library[0].p_map, library[0].views[0], p)));
  EXPECT_NEAR(p.cosine, 0, 1e-5);
  EXPECT_EQ(find_visible(library, camera, pose, options, {}, out, 2), 0);
  EXPECT_EQ(find_visible(library, camera, Rigid<float>(), options, {}, out, 2), 1);
}

TEST(FindVisible, TheNearestViewIsChosen) {
  LandmarkMaker maker(6);
  const auto camera = vga_camera<float>();
  MapLibrary<SmallConfig, 2> library;
  Health health;
  LibraryLandmark<float, 2> l = maker.landmark<2>(1);
  l.p_map = Vector3<float>(0, 0, 3);
  l.view_count = 2;
  for (auto& view : l.views) view = seen_from_origin(maker, 1, l.p_map).views[0];
  l.views[0].T_map_reference.translation = Vector3<float>(2, 0, 0);
  ASSERT_TRUE(ok(library.insert(l, health)));
  VisibleLandmark<float> out[1];
  ASSERT_EQ(find_visible(library, camera, Rigid<float>(), {}, {}, out, 1), 1);
  EXPECT_EQ(out[0].view, 1);
}

}  // namespace
}  // namespace cairn
