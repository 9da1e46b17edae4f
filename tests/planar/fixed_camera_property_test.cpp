// The filter of pixels without floating point under any input, and over a long drive.
#include <memory>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "any_fixed.hpp"
#include "fixed_camera_drive.hpp"

namespace cairn {
namespace {

using Filter = FixedGroupSlam<4, 3>;
using planar_test::any;

FixedCovariance3 any_covariance() {
  const FixedCovariance2 c = planar_test::any_covariance();
  return {c.xx, c.xy, c.yy, any<FixedVariance>(), {}, any<FixedVariance>()};
}

FixedMount any_mount() {
  FixedMount mount;
  if (*rc::gen::arbitrary<bool>()) {
    mount.w = mount.y = FixedRatio::nearest(0.5);
    mount.x = mount.z = FixedRatio::nearest(-0.5);
  }
  if (*rc::gen::inRange(0, 8) == 0) mount.x = any<FixedRatio>();
  for (FixedLength& coordinate : mount.origin) coordinate = any<FixedLength>();
  return mount;
}

FixedCamera any_camera() {
  FixedCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = any<FixedPixel>();
  camera.fy = any<FixedPixel>();
  camera.cx = any<FixedPixel>();
  camera.cy = any<FixedPixel>();
  if (*rc::gen::arbitrary<bool>()) {
    for (FixedTangent* k : {&camera.k1, &camera.k2, &camera.k3, &camera.p1, &camera.p2}) {
      *k = any<FixedTangent>();
    }
  }
  return camera;
}

/// One match is a consensus.
constexpr FixedRansacParameters kAnyone = [] {
  FixedRansacParameters ransac;
  ransac.min_inliers = 1;
  ransac.min_inlier_share = FixedRatio();
  return ransac;
}();
FixedRansacParameters any_ransac() {
  FixedRansacParameters ransac;
  ransac.probability = any<FixedRatio>();
  ransac.max_hypotheses = *rc::gen::arbitrary<int>();
  ransac.min_inliers = *rc::gen::arbitrary<int>();
  ransac.min_inlier_share = any<FixedRatio>();
  return ransac;
}

/// One call with arbitrary arguments; refusals are as good as any other answer.
void step(Filter& filter) {
  const auto id = *rc::gen::inRange<LandmarkId>(0, 7);
  switch (*rc::gen::inRange(0, 8)) {
    case 0: {
      FixedPoseCovariance covariance;
      covariance.position = planar_test::any_covariance();
      covariance.heading = any<FixedVariance>();
      FixedPlanarParameters parameters;
      parameters.tilt.sigma_pitch = any<FixedAngle>();
      parameters.tilt.sigma_roll = any<FixedAngle>();
      parameters.tilt.time_constant = any<FixedOffset>();
      parameters.ransac = *rc::gen::arbitrary<bool>() ? kAnyone : any_ransac();
      parameters.ransac_threshold = any<FixedScore>();
      parameters.rescue_gate = any<FixedScore>();
      (void)filter.initialise({any<FixedCoordinate>(), any<FixedCoordinate>(), any<FixedAngle>()},
                              covariance, parameters);
      return;
    }
    case 1: {
      FixedIncrement increment;
      increment.distance = any<FixedOffset>();
      increment.turn = any<FixedAngle>();
      increment.distance_variance = any<FixedVariance>();
      increment.turn_variance = any<FixedVariance>();
      (void)filter.predict(increment);
      return;
    }
    case 2:
      (void)filter.predict_tilt(any<FixedOffset>());
      return;
    case 3: {
      FixedPixelMatch matches[5];
      for (FixedPixelMatch& match : matches) {
        match.id = *rc::gen::inRange<LandmarkId>(0, 7);
        for (FixedPixel& pixel : match.pixel) pixel = any<FixedPixel>();
      }
      const int count = *rc::gen::inRange(0, 6);
      FixedUpdateReport report;
      if (*rc::gen::arbitrary<bool>()) {
        Random random(id);
        (void)filter.update_pixels(any_camera(), any_mount(), any<FixedPixel>(), matches, count,
                                   random, report);
        return;
      }
      (void)filter.update_pixels(any_camera(), any_mount(), any<FixedPixel>(), matches, count,
                                 report);
      return;
    }
    case 4: {
      FixedPixelPrediction prediction;
      FixedVector<FixedPlannedPixel, 4> plan;
      (void)filter.plan_pixels(any_camera(), any_mount(), any<FixedPixel>(), plan);
      const int slot = *rc::gen::inRange(-1, 5);
      (void)filter.predict_pixel(slot, any_camera(), any_mount(), any<FixedPixel>(), prediction);
      return;
    }
    case 5:
      (void)filter.update_height(id, any<FixedLength>(), any<FixedLength>(), any<FixedScore>());
      return;
    case 6:
      (void)filter.remove_landmark(*rc::gen::inRange(-1, 5));
      return;
    default: {
      const FixedLength y[3] = {any<FixedLength>(), any<FixedLength>(), any<FixedLength>()};
      (void)filter.add_landmark(id, y, any_covariance());
      return;
    }
  }
}

TEST(FixedPixelProperty, StaysSoundUnderAnyInput) {
  EXPECT_TRUE(rc::check([] {
    const auto filter = std::make_unique<Filter>();
    FixedPlanarParameters parameters;
    parameters.ransac = kAnyone;
    if (*rc::gen::arbitrary<bool>()) {
      parameters.tilt.sigma_pitch = FixedAngle::nearest(0.01);
      parameters.tilt.sigma_roll = FixedAngle::nearest(0.02);
    }
    RC_ASSERT(ok(filter->initialise({}, {}, parameters)));
    for (int k = 0; k < 40; ++k) step(*filter);
    FixedPose pose;
    FixedPoseCovariance covariance;
    filter->pose(pose, covariance);
    RC_ASSERT(covariance.heading.raw() >= 0);
    RC_ASSERT(filter->tilt_covariance().xx.raw() >= 0);
    for (int slot = 0; slot < filter->landmark_count(); ++slot) {
      RC_ASSERT(filter->landmark_height_variance(slot).raw() >= 0);
      (void)filter->landmark(slot);
    }
  }));
}

/// Now and then a match passes the gate of one of the two alone. The floor under the body has no
/// fixed place, so what that tilts it by, some 1e-4 rad, stays.
TEST(FixedPixelProperty, StaysDoublesOverALongDrive) {
  planar_test::FixedCameraDrive<20> drive(7, true);
  for (int k = 0; k < 4000; ++k) {
    drive.move();
    drive.look();
    if (k % 9 == 8) drive.forget(static_cast<LandmarkId>(1 + k % 60));
    if (k % 100 != 99) continue;
    ASSERT_TRUE(drive.good()) << k;
    ASSERT_LT(drive.mean_difference(), 4e-3) << k;
    ASSERT_LT(drive.covariance_difference(), 4e-3) << k;
  }
  EXPECT_GT(drive.used(), 10000);
  EXPECT_EQ(drive.fixed().saturations(), 0U);
}

}  // namespace
}  // namespace cairn
