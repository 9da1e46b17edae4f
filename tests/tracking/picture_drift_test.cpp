#include "cairn/tracking/picture_drift.hpp"

#include <gtest/gtest.h>

namespace cairn {
namespace {

struct Filter {
  int drift_world(float position, float heading) {
    position_variance += position;
    heading_variance += heading;
    return 0;
  }
  float position_variance = 0.0F;
  float heading_variance = 0.0F;
};

constexpr float kFocal_px = 500.0F;
constexpr int kMany = 30;

TEST(PictureDrift, GrowsWithTheWayAndNotWithTheFrames) {
  Filter at_once;
  Filter in_steps;
  const PictureDrift drift;
  drift.add_to(at_once, 4.0F, kFocal_px, kMany);
  for (int i = 0; i < 40; ++i) drift.add_to(in_steps, 0.1F, kFocal_px, kMany);
  EXPECT_NEAR(at_once.position_variance, square(0.02F), 1e-8F);
  EXPECT_NEAR(at_once.heading_variance, square(0.0016F), 1e-10F);
  EXPECT_NEAR(in_steps.position_variance, at_once.position_variance, 1e-8F);
  EXPECT_NEAR(in_steps.heading_variance, at_once.heading_variance, 1e-10F);
  drift.add_to(at_once, 0.0F, kFocal_px, kMany);
  EXPECT_NEAR(at_once.position_variance, square(0.02F), 1e-8F) << "it stands";
}

/// 116 px of focal length and eight landmarks turn the map by 3 mrad in a metre.
TEST(PictureDrift, BendsTheMapMoreWhereFewLandmarksAreSeenByWidePixels) {
  const PictureDrift drift;
  Filter few;
  drift.add_to(few, 1.0F, 116.0F, 8);
  EXPECT_NEAR(few.heading_variance, square(3.048e-3F), 1e-8F);
  Filter fewer;
  drift.add_to(fewer, 1.0F, 116.0F, 4);
  EXPECT_NEAR(fewer.heading_variance, 2.0F * few.heading_variance, 1e-8F);
  Filter none;
  drift.add_to(none, 1.0F, 116.0F, 0);
  EXPECT_EQ(none.heading_variance, fewer.heading_variance);
}

}  // namespace
}  // namespace cairn
