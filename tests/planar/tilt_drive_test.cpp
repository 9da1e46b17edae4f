#include <gtest/gtest.h>

#include "cairn/planar/ekf_slam.hpp"
#include "cairn/planar/group_iekf_slam.hpp"

#include "tilting_drive.hpp"

namespace cairn {
namespace {

using planar_test::Consistency;
using planar_test::drive;
using planar_test::Floor;
using planar_test::suspension;

using Group = GroupIekfSlam<double, 40, 3>;
using Ekf = EkfSlam<double, 40, 3>;

template <class Filter>
class TiltedDrive : public ::testing::Test {};
using Filters = ::testing::Types<Group, Ekf>;
TYPED_TEST_SUITE(TiltedDrive, Filters, );

/// Errors of one drive go together: 40 drives bound the mean NEES to about a seventh of itself.
TYPED_TEST(TiltedDrive, PoseAndTiltAreAsUncertainAsTheySay) {
  const Consistency known = drive<TypeParam>(40, {suspension()});
  ::testing::Test::RecordProperty("pose_nees_permille", static_cast<int>(1e3 * known.pose));
  ::testing::Test::RecordProperty("tilt_nees_permille", static_cast<int>(1e3 * known.tilt));
  ::testing::Test::RecordProperty("nis_permille", static_cast<int>(1e3 * known.nis));
  ::testing::Test::RecordProperty("heading_urad", static_cast<int>(1e6 * known.heading_rad));
  EXPECT_NEAR(known.pose, 3.0, 1.2);
  // Cautious: heights share the tilt's error, which the turn of the map does not take into account.
  EXPECT_GT(known.tilt, 0.5);
  EXPECT_LT(known.tilt, 2.6);
  EXPECT_NEAR(known.nis, 1.0, 0.05);
  EXPECT_GT(known.inlier_share, 0.97);
}

/// The floor may as well stay flat, and the body return to it.
TYPED_TEST(TiltedDrive, PoseIsAsUncertainAsItSaysOnAFlatFloor) {
  const Consistency known = drive<TypeParam>(40, {suspension(), 1.0, Floor::kFlat});
  EXPECT_NEAR(known.pose, 3.0, 1.2);
  EXPECT_NEAR(known.nis, 1.0, 0.05);
  EXPECT_GT(known.inlier_share, 0.97);
}

/// A filter that does not know of the tilt refuses most of what it sees.
TYPED_TEST(TiltedDrive, WithoutTiltMostMatchesAreRefused) {
  const Consistency unknown = drive<TypeParam>(10, {});
  EXPECT_LT(unknown.inlier_share, 0.5);
}

/// Where the body stays level, a filter that allows a tilt is as good within a fifth.
TYPED_TEST(TiltedDrive, ALevelBodyLosesLittle) {
  const Consistency level = drive<TypeParam>(20, {{}, 0.0});
  const Consistency allowed = drive<TypeParam>(20, {suspension(), 0.0});
  EXPECT_LT(allowed.heading_rad, 1.2 * level.heading_rad);
}

}  // namespace
}  // namespace cairn
