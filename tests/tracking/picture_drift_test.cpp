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

TEST(PictureDrift, GrowsWithTheWayAndNotWithTheFrames) {
  Filter at_once;
  Filter in_steps;
  const PictureDrift drift;
  drift.add_to(at_once, 4.0F);
  for (int i = 0; i < 40; ++i) drift.add_to(in_steps, 0.1F);
  EXPECT_NEAR(at_once.position_variance, square(0.02F), 1e-8F);
  EXPECT_NEAR(at_once.heading_variance, square(0.0016F), 1e-10F);
  EXPECT_NEAR(in_steps.position_variance, at_once.position_variance, 1e-8F);
  EXPECT_NEAR(in_steps.heading_variance, at_once.heading_variance, 1e-10F);
  drift.add_to(at_once, 0.0F);
  EXPECT_NEAR(at_once.position_variance, square(0.02F), 1e-8F) << "it stands";
}

}  // namespace
}  // namespace cairn
