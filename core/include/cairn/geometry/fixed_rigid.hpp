#pragma once

#include "cairn/geometry/fixed_camera.hpp"
#include "cairn/geometry/rigid.hpp"

namespace cairn {

using FixedCoordinate = Fixed<std::int64_t, 32>;  ///< m
using FixedOffset = Fixed<std::int32_t, 24>;      ///< m, +-128

/// As Rigid, without floating point: a unit quaternion (w, x, y, z) and a translation.
struct FixedRigid {
  FixedRatio rotation[4] = {FixedRatio::nearest(1.0)};
  FixedCoordinate translation[3];

  /// T_a_b * T_b_c. What does not fit saturates, counted.
  FixedRigid times(const FixedRigid& other, std::uint32_t& saturations) const;
};

/// By the bits of their numbers. Domain of the rotation: a unit quaternion to 1e-3.
FixedRigid fixed_rigid_of(const Rigid<float>& pose, std::uint32_t& saturations);
Rigid<float> float_of(const FixedRigid& pose);
FixedRigid fixed_rigid_of(const FixedMount& mount);

/// A rotation about an axis.
FixedRigid turn_about(int axis, FixedAngle angle);
/// A rotation about (x, y, z), rad with 32 fraction bits; right to 4e-9 below 0.3 rad, and defined
/// for every input.
FixedRigid small_turn(std::int64_t x, std::int64_t y, std::int64_t z);

namespace detail {

/// A motion of less than 128 m: p_a = R p_b + t.
struct FixedMotionBetween {
  FixedRotation R;
  FixedOffset t[3];
};
/// T_a_b of T_world_a and T_world_b; saturates, counted.
FixedMotionBetween motion_between(const FixedRigid& T_world_a, const FixedRigid& T_world_b,
                                  std::uint32_t& saturations);
FixedRotation rotation_of(const FixedRigid& pose);

}  // namespace detail
}  // namespace cairn
