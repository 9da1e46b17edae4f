// Poses in fixed point for any operands, against integers of 128 bits.
#include <cmath>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "cairn/geometry/fixed_rigid.hpp"

#include "any_integer.hpp"

namespace cairn {
namespace {

constexpr int kRatioBits = FixedRatio::kFractionBits;

/// A unit quaternion to 2^-29, and a translation below 2^`bits`.
FixedRigid any_pose(int bits) {
  FixedRigid pose;
  double q[4];
  double squared = 0.0;
  for (double& part : q) {
    part = static_cast<double>(*operand_of(30));
    squared += part * part;
  }
  if (squared == 0.0) squared = q[0] = 1.0;
  for (int i = 0; i < 4; ++i) {
    pose.rotation[i] = FixedRatio::from_raw(
        static_cast<std::int32_t>(std::lround(q[i] / std::sqrt(squared) * (1 << kRatioBits))));
  }
  for (FixedCoordinate& t : pose.translation) t = FixedCoordinate::from_raw(*operand_of(bits));
  return pose;
}
Int128 raw(const FixedRatio& ratio) {
  return ratio.raw();
}
/// Exact, with kRatioBits more of fraction.
Int128 turned(const detail::FixedRotation& R, int i, const Int128 (&v)[3]) {
  return raw(R.r[i][0]) * v[0] + raw(R.r[i][1]) * v[1] + raw(R.r[i][2]) * v[2];
}

TEST(FixedRigidProperty, TranslationsAreRightToTwoUnits) {
  EXPECT_TRUE(rc::check([] {
    const FixedRigid a = any_pose(52);
    const FixedRigid b = any_pose(52);
    std::uint32_t count = 0;
    const FixedRigid product = a.times(b, count);
    RC_ASSERT(count == 0U);
    const Int128 v[3] = {b.translation[0].raw(), b.translation[1].raw(), b.translation[2].raw()};
    const detail::FixedRotation R = detail::rotation_of(a);
    for (int i = 0; i < 3; ++i) {
      const Int128 exact = turned(R, i, v) + (Int128{a.translation[i].raw()} << kRatioBits);
      const Int128 off = (Int128{product.translation[i].raw()} << kRatioBits) - exact;
      RC_ASSERT(magnitude128(off) <= Int128{2} << kRatioBits);
    }
  }));
}

/// To eight units: those of the product, and of its length.
TEST(FixedRigidProperty, RotationsAreProductsOfUnitLength) {
  EXPECT_TRUE(rc::check([] {
    const FixedRigid a = any_pose(40);
    const FixedRigid b = any_pose(40);
    std::uint32_t count = 0;
    const FixedRigid product = a.times(b, count);
    const auto of = [&](int i, int j) { return raw(a.rotation[i]) * raw(b.rotation[j]); };
    const Int128 exact[4] = {
        of(0, 0) - of(1, 1) - of(2, 2) - of(3, 3), of(0, 1) + of(1, 0) + of(2, 3) - of(3, 2),
        of(0, 2) - of(1, 3) + of(2, 0) + of(3, 1), of(0, 3) + of(1, 2) - of(2, 1) + of(3, 0)};
    Int128 squared = 0;
    for (int i = 0; i < 4; ++i) {
      const Int128 off = (raw(product.rotation[i]) << kRatioBits) - exact[i];
      RC_ASSERT(magnitude128(off) <= Int128{8} << kRatioBits);
      squared += raw(product.rotation[i]) * raw(product.rotation[i]);
    }
    RC_ASSERT(magnitude128(squared - (Int128{1} << (2 * kRatioBits))) <= Int128{8}
                                                                             << (kRatioBits + 1));
  }));
}

TEST(FixedRigidProperty, MotionsBetweenPosesAreRightToAUnitOfTheirs) {
  EXPECT_TRUE(rc::check([] {
    const FixedRigid a = any_pose(52);
    FixedRigid b = any_pose(52);
    Int128 v[3];
    for (int i = 0; i < 3; ++i) {
      const std::int64_t step = *operand_of(36);  // 16 m
      b.translation[i] = FixedCoordinate::from_raw(a.translation[i].raw() + step);
      v[i] = step;
    }
    std::uint32_t count = 0;
    const detail::FixedMotionBetween motion = detail::motion_between(a, b, count);
    RC_ASSERT(count == 0U);
    const detail::FixedRotation R = detail::rotation_of(a).transposed();
    constexpr int kDown = kRatioBits + FixedCoordinate::kFractionBits - FixedOffset::kFractionBits;
    for (int i = 0; i < 3; ++i) {
      const Int128 off = (Int128{motion.t[i].raw()} << kDown) - turned(R, i, v);
      RC_ASSERT(magnitude128(off) <= Int128{1} << kDown);
    }
  }));
}

}  // namespace
}  // namespace cairn
