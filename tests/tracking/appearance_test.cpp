#include "cairn/tracking/appearance.hpp"

#include <gtest/gtest.h>

#include "cairn/vision/fast.hpp"
#include "cairn/vision/hamming.hpp"

#include "plane_scene.hpp"

namespace cairn {
namespace {

using test::PlaneScene;

Rigid<double> looking_along_z(double x, double y, double z, double roll) {
  return {rotation_exp(Vector3<double>(0, 0, roll)), {x, y, z}};
}

class Warp : public ::testing::Test {
 protected:
  Matrix2<double> warp_to(const Rigid<double>& T_world_camera, const Vector3<double>& p_world) {
    Matrix2<double> warp;
    EXPECT_TRUE(ok(predict_warp(camera_, Rigid<double>{}, T_world_camera,
                                Vector3<double>(T_world_camera.inverse() * p_world), warp)));
    return warp;
  }
  PinholeCamera<double> camera_ = test::small_camera();
};

TEST_F(Warp, IsIdentityFromTheReferenceView) {
  EXPECT_NEAR((warp_to(Rigid<double>{}, {0.3, -0.2, 2.0}) - Matrix2<double>::Identity()).norm(), 0,
              1e-12);
}

TEST_F(Warp, TurnsAgainstTheCamerasRoll) {
  const double roll = 0.4;
  const Matrix2<double> warp = warp_to(looking_along_z(0, 0, 0, roll), {0, 0, 2});
  Matrix2<double> expected;
  expected << std::cos(roll), std::sin(roll), -std::sin(roll), std::cos(roll);
  EXPECT_NEAR((warp - expected).norm(), 0, 1e-12);
}

TEST_F(Warp, GrowsWithNearness) {
  EXPECT_NEAR(warp_scale(warp_to(looking_along_z(0, 0, 1, 0), {0, 0, 2})), 2.0, 1e-12);
}

TEST_F(Warp, RefusesPointsBehindEitherCamera) {
  Matrix2<double> warp;
  EXPECT_EQ(
      predict_warp(camera_, Rigid<double>{}, Rigid<double>{}, Vector3<double>(0, 0, -1), warp),
      Status::kOutOfView);
  EXPECT_EQ(predict_warp(camera_, looking_along_z(0, 0, 9, 0), Rigid<double>{},
                         Vector3<double>(0, 0, 2), warp),
            Status::kOutOfView);
}

TEST(Steer, ScaleAndRollBecomeSteps) {
  Matrix2<double> quarter_turn_twice_as_large;
  quarter_turn_twice_as_large << 0, -2, 2, 0;
  const FreakPose pose = steer(quarter_turn_twice_as_large, 4);
  EXPECT_EQ(pose.orientation_bin, 64);
  EXPECT_EQ(pose.scale_index, 20);
  EXPECT_EQ(steer(Matrix2<double>(0.1 * Matrix2<double>::Identity()), 4).scale_index, 0);
  EXPECT_EQ(steer(Matrix2<double>(Matrix2<double>::Zero()), 4).scale_index, 0);
}

// A corner seen again from a rolled and nearer camera: described at the predicted pose it is far
// more alike than described upright. This fixes the sign of the orientation bin.
TEST(Steer, DescriptorSurvivesRollAndScale) {
  const PlaneScene scene(2.0);
  const PinholeCamera<double> camera = test::small_camera();
  const Rigid<double> T_reference;
  const auto first = scene.render(camera, T_reference);
  FastScratch<320> scratch;
  Corner corners[64];
  FastReport report;
  ASSERT_TRUE(ok(detect_fast(test::view(first, camera), {90, 70, 230, 170}, 30, scratch, corners,
                             64, report)));
  ASSERT_GT(report.found, 10);

  const Rigid<double> T_second = looking_along_z(0.05, -0.03, 0.5, 0.5);
  const auto second = scene.render(camera, T_second);
  double steered_sum = 0;
  double upright_sum = 0;
  int used = 0;
  for (int i = 0; i < report.found - report.dropped; ++i) {
    Appearance appearance;
    if (!ok(make_appearance(test::view(first, camera), corners[i].x, corners[i].y,
                            test::to_float(T_reference), appearance))) {
      continue;
    }
    const Vector3<double> p_world = 2.0 * camera.unproject({corners[i].x, corners[i].y});
    const Vector3<double> p_camera = T_second.inverse() * p_world;
    Vector2<double> pixel;
    Matrix2<double> warp;
    ASSERT_TRUE(ok(camera.project(p_camera, pixel)));
    ASSERT_TRUE(ok(predict_warp(camera, T_reference, T_second, p_camera, warp)));
    Descriptor steered, upright;
    const int x = round_to_int(pixel.x());
    const int y = round_to_int(pixel.y());
    if (!ok(describe_freak(test::view(second, camera), x, y, steer(warp, kReferenceScaleIndex),
                           steered)) ||
        !ok(describe_freak(test::view(second, camera), x, y, FreakPose{0, kReferenceScaleIndex},
                           upright))) {
      continue;
    }
    steered_sum += hamming_distance(appearance.descriptor, steered);
    upright_sum += hamming_distance(appearance.descriptor, upright);
    ++used;
  }
  ASSERT_GE(used, 8);
  EXPECT_LT(steered_sum / used, 80.0);
  EXPECT_GT(upright_sum, 1.5 * steered_sum);
}

/// A picture of 80 rows leaves a descriptor 22 of them, a patch 66.
TEST(PatchAppearance, NeedsLessOfTheBorderThanADescriptor) {
  const PinholeCamera<double> camera = test::small_camera();
  const auto pixels = PlaneScene(2.0).render(camera, Rigid<double>{});
  const ImageView image = test::view(pixels, camera);
  const int described = freak_margin(kReferenceScaleIndex);
  Appearance appearance;
  ASSERT_TRUE(ok(make_patch_appearance(image, described, 100, Rigid<float>{}, appearance)));
  EXPECT_TRUE(appearance.has_descriptor);
  EXPECT_TRUE(ok(make_appearance(image, described, 100, Rigid<float>{}, appearance)));
  for (const int x : {7, described - 1}) {
    ASSERT_TRUE(ok(make_patch_appearance(image, x, 100, Rigid<float>{}, appearance))) << x;
    EXPECT_TRUE(appearance.has_patch);
    EXPECT_FALSE(appearance.has_descriptor);
    EXPECT_EQ(make_appearance(image, x, 100, Rigid<float>{}, appearance), Status::kOutOfView);
  }
  EXPECT_EQ(make_patch_appearance(image, 6, 100, Rigid<float>{}, appearance), Status::kOutOfView);
}

}  // namespace
}  // namespace cairn
