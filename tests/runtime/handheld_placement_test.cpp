#include "cairn/runtime/handheld_placement.hpp"

#include <algorithm>

#include <gtest/gtest.h>

namespace {

using cairn::Random;
using cairn::Rigid;
using Vector = cairn::Vector3<float>;
using Scene = cairn::ScenePoints<32>;

/// Looks down at 45 degrees, from 2 above and 1 to the side of the map's origin.
Rigid<float> camera_pose() {
  return {cairn::rotation_exp<float>({-0.75F * 3.14159265F, 0.0F, 0.0F}), {1.0F, -2.0F, 2.0F}};
}

void add(const Vector& p_map, Scene& scene) {
  scene.add(p_map, (camera_pose().inverse() * p_map).z());
}

/// A grid on the plane z = 0.
Scene table(int rows) {
  Scene scene;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < 4; ++x) {
      add({0.4F + 0.3F * static_cast<float>(x), -0.5F + 0.3F * static_cast<float>(y), 0.0F}, scene);
    }
  }
  return scene;
}

Vector seen_at(const Rigid<float>& T_map_object) {
  const Vector p = camera_pose().inverse() * T_map_object.translation;
  return p / p.z();
}

TEST(HandheldPlacement, AnObjectStandsOnThePlaneWhereTheRayMeetsIt) {
  const Scene scene = table(5);
  const Vector ray(0.2F, -0.1F, 1.0F);
  Random random(1);
  Rigid<float> place;
  ASSERT_TRUE(place_on_ray(scene, camera_pose(), ray, random, place));
  EXPECT_NEAR(place.translation.z(), 0.0F, 1e-4F);
  EXPECT_NEAR((seen_at(place) - ray).norm(), 0.0F, 1e-4F);
  EXPECT_NEAR((place.rotation * Vector(0.0F, 0.0F, 1.0F)).z(), 1.0F, 1e-4F);
}

TEST(HandheldPlacement, WithoutAPlaneItIsAsFarAsThePointBesideTheRay) {
  Scene scene;
  for (int i = 0; i < 12; ++i) {
    const auto t = static_cast<float>(i);
    const Vector p_camera = (2.0F + static_cast<float>(i * i % 7)) *
                            Vector(-0.5F + 0.09F * t, 0.1F * static_cast<float>(i % 3), 1.0F);
    add(camera_pose() * p_camera, scene);
  }
  const Vector beside = camera_pose().inverse() * scene.points[5];
  const Vector ray(beside.x() / beside.z() + 0.01F, beside.y() / beside.z(), 1.0F);
  Random random(1);
  Rigid<float> place;
  ASSERT_TRUE(place_on_ray(scene, camera_pose(), ray, random, place));
  EXPECT_NEAR((camera_pose().inverse() * place.translation).z(), beside.z(), 1e-4F);
  EXPECT_NEAR((seen_at(place) - ray).norm(), 0.0F, 1e-4F);
  const Vector up =
      camera_pose().rotation.conjugate() * (place.rotation * Vector(0.0F, 0.0F, 1.0F));
  EXPECT_NEAR(up.y(), -1.0F, 1e-5F);
}

TEST(HandheldPlacement, ARayAboveThePlanesHorizonFindsADepthAllTheSame) {
  const Vector up(0.0F, -2.0F, 1.0F);
  Random random(1);
  Rigid<float> place;
  ASSERT_TRUE(place_on_ray(table(5), camera_pose(), up, random, place));
  const float depth = (camera_pose().inverse() * place.translation).z();
  EXPECT_GT(depth, 0.5F);
  EXPECT_LT(depth, 10.0F);
}

TEST(HandheldPlacement, TooFewPointsLeaveThePlaceUnchanged) {
  Random random(1);
  Rigid<float> place;
  place.translation = Vector(7.0F, 8.0F, 9.0F);
  EXPECT_FALSE(place_on_ray(table(2), camera_pose(), Vector(0.0F, 0.0F, 1.0F), random, place));
  EXPECT_EQ(place.translation, Vector(7.0F, 8.0F, 9.0F));
}

/// Three numbers of [0, 1), drawn in this order.
Vector uniform(Random& random) {
  Vector v;
  for (int k = 0; k < 3; ++k) v[k] = 0.001F * static_cast<float>(random.below(1000));
  return v;
}

/// `on` points of the table z = 0, and points scattered over a depth of 1 above it.
Scene cluttered_table(int on, int scattered) {
  Scene scene;
  Random random(7);
  for (int i = 0; i < on + scattered; ++i) {
    const Vector v = uniform(random);
    add({2.0F * v.x(), -1.0F + 2.0F * v.y(), i < on ? 0.0F : 0.2F + 0.8F * v.z()}, scene);
  }
  return scene;
}

TEST(HandheldPlacement, AnObjectStandsAtAFeatureOfThePlaneAmongClutter) {
  const Scene scene = cluttered_table(16, 14);
  Random random(1);
  Rigid<float> place;
  ASSERT_TRUE(place_on_plane(scene, camera_pose(), random, place));
  EXPECT_NEAR(place.translation.z(), 0.0F, 0.02F);
  EXPECT_GT((place.rotation * Vector(0.0F, 0.0F, 1.0F)).z(), 0.999F);
  float nearest = 10.0F;
  for (const Vector& p : scene.points) nearest = std::min(nearest, (p - place.translation).norm());
  EXPECT_LT(nearest, 0.05F);
}

TEST(HandheldPlacement, WithoutAPlaneNothingIsPlacedButByChance) {
  Rigid<float> place;
  place.translation = Vector(7.0F, 8.0F, 9.0F);
  const Random random(3);
  int placed = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Scene scene;
    Random points(seed);
    for (int i = 0; i < 30; ++i) {
      const Vector v = uniform(points) - Vector::Constant(0.5F);
      const float depth = 3.0F * (1.0F + v.z());
      scene.add(camera_pose() * (depth * Vector(v.x(), v.y(), 1.0F)), depth);
    }
    Rigid<float> anywhere = place;
    Random draws = random;
    if (place_on_plane(scene, camera_pose(), draws, anywhere)) {
      ++placed;
      continue;
    }
    EXPECT_TRUE(anywhere.translation == place.translation);
    Random untouched = random;
    EXPECT_EQ(draws.below(1 << 20), untouched.below(1 << 20));
  }
  EXPECT_LE(placed, 20);  // 10 %, as least_on_plane() states
}

}  // namespace
