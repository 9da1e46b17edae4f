#include "cairn/geometry/fixed_rigid.hpp"

#include "cairn/numeric/float_bits.hpp"

namespace cairn {
namespace {

using Count = std::uint32_t;

constexpr int kRatioBits = FixedRatio::kFractionBits;

/// A step of Newton's method to length 1.
void normalise(FixedRatio (&q)[4]) {
  std::int64_t squared = 0;
  for (const FixedRatio& part : q) squared += std::int64_t{part.raw()} * part.raw() / 4;
  // (3 - |q|^2) / 2, of squared lengths up to 3.
  const std::int64_t factor =
      (std::int64_t{3} << (kRatioBits - 1)) - wide::round_shift(squared, kRatioBits - 1);
  Count none = 0;
  for (FixedRatio& part : q) {
    const std::int64_t scaled = wide::multiply(part.raw(), factor, kRatioBits, none);
    part = FixedRatio::from_raw(wide::narrow(scaled, none));
  }
}

/// A vector of 64-bit coordinates, turned, right to a unit; below 2^54.
template <class To>
void turn(const detail::FixedRotation& R, const std::int64_t (&v)[3], To (&out)[3], Count& count) {
  constexpr int kLowBits = 24;
  constexpr std::int64_t kMost = std::int64_t{1} << 54;
  std::int32_t high[3];
  std::int32_t low[3];
  for (int j = 0; j < 3; ++j) {
    const std::int64_t bounded = v[j] > kMost ? kMost : v[j] < -kMost ? -kMost : v[j];
    if (bounded != v[j]) ++count;
    high[j] = static_cast<std::int32_t>(bounded >> kLowBits);
    low[j] = static_cast<std::int32_t>(bounded & ((1 << kLowBits) - 1));
  }
  for (int i = 0; i < 3; ++i) {
    std::int64_t sum = 0;
    std::int64_t rest = 0;
    for (int j = 0; j < 3; ++j) {
      sum += std::int64_t{R.r[i][j].raw()} * high[j] >> 1;
      rest += std::int64_t{R.r[i][j].raw()} * low[j];
    }
    sum += rest >> (kLowBits + 1);
    out[i] = convert<To>(
        FixedCoordinate::from_raw(wide::round_shift(sum, kRatioBits - kLowBits - 1)), count);
  }
}

}  // namespace

namespace detail {

FixedRotation rotation_of(const FixedRigid& pose) {
  FixedMount mount;
  mount.w = pose.rotation[0];
  mount.x = pose.rotation[1];
  mount.y = pose.rotation[2];
  mount.z = pose.rotation[3];
  return rotation_of(mount);
}

FixedMotionBetween motion_between(const FixedRigid& T_world_a, const FixedRigid& T_world_b,
                                  Count& saturations) {
  FixedMotionBetween out;
  const FixedRotation R_a_world = rotation_of(T_world_a).transposed();
  out.R = R_a_world * rotation_of(T_world_b);
  std::int64_t way[3];
  for (int i = 0; i < 3; ++i) {
    way[i] = subtract(T_world_b.translation[i], T_world_a.translation[i], saturations).raw();
  }
  turn(R_a_world, way, out.t, saturations);
  return out;
}

}  // namespace detail

FixedRigid FixedRigid::times(const FixedRigid& other, Count& saturations) const {
  FixedRigid out;
  const auto product = [&](int i, int j) {
    return std::int64_t{rotation[i].raw()} * other.rotation[j].raw() >> 1;
  };
  const auto part = [](std::int64_t sum) {
    Count none = 0;
    return FixedRatio::from_raw(wide::narrow(wide::round_shift(sum, kRatioBits - 1), none));
  };
  out.rotation[0] = part(product(0, 0) - product(1, 1) - product(2, 2) - product(3, 3));
  out.rotation[1] = part(product(0, 1) + product(1, 0) + product(2, 3) - product(3, 2));
  out.rotation[2] = part(product(0, 2) - product(1, 3) + product(2, 0) + product(3, 1));
  out.rotation[3] = part(product(0, 3) + product(1, 2) - product(2, 1) + product(3, 0));
  normalise(out.rotation);
  std::int64_t way[3];
  for (int i = 0; i < 3; ++i) way[i] = other.translation[i].raw();
  turn(detail::rotation_of(*this), way, out.translation, saturations);
  for (int i = 0; i < 3; ++i) {
    out.translation[i] = add(out.translation[i], translation[i], saturations);
  }
  return out;
}

FixedRigid fixed_rigid_of(const Rigid<float>& pose, Count& saturations) {
  FixedRigid out;
  const Quaternion<float>& q = pose.rotation;
  const float parts[4] = {q.w(), q.x(), q.y(), q.z()};
  for (int i = 0; i < 4; ++i) out.rotation[i] = fixed_of<FixedRatio>(parts[i], saturations);
  normalise(out.rotation);
  for (int i = 0; i < 3; ++i) {
    out.translation[i] = fixed_of<FixedCoordinate>(pose.translation(i), saturations);
  }
  return out;
}

FixedRigid fixed_rigid_of(const FixedMount& mount) {
  FixedRigid out;
  out.rotation[0] = mount.w;
  out.rotation[1] = mount.x;
  out.rotation[2] = mount.y;
  out.rotation[3] = mount.z;
  normalise(out.rotation);
  Count none = 0;
  for (int i = 0; i < 3; ++i) {
    out.translation[i] = convert<FixedCoordinate>(mount.origin[i], none);
  }
  return out;
}

Rigid<float> float_of(const FixedRigid& pose) {
  Rigid<float> out;
  out.rotation = Quaternion<float>(float_of(pose.rotation[0]), float_of(pose.rotation[1]),
                                   float_of(pose.rotation[2]), float_of(pose.rotation[3]));
  for (int i = 0; i < 3; ++i) out.translation(i) = float_of(pose.translation[i]);
  return out;
}

FixedRigid turn_about(int axis, FixedAngle angle) {
  FixedRigid out;
  sin_cos(FixedAngle::from_raw(angle.raw() / 2), out.rotation[axis + 1], out.rotation[0]);
  return out;
}

FixedRigid small_turn(std::int64_t x, std::int64_t y, std::int64_t z) {
  // cos and sin of half the angle by their series: 1 - s / 8 + s^2 / 384, and of the vector
  // 1 / 2 - s / 48 + s^2 / 3840, s its squared length.
  Count none = 0;
  const std::int64_t v[3] = {x, y, z};
  std::int32_t phi[3];
  std::int64_t s = 0;
  for (int i = 0; i < 3; ++i) {
    constexpr std::int32_t kMost = FixedRatio::nearest(0.5).raw();
    const std::int64_t narrow = wide::round_shift(v[i], 32 - kRatioBits);
    phi[i] = static_cast<std::int32_t>(narrow > kMost ? kMost : narrow < -kMost ? -kMost : narrow);
    s += std::int64_t{phi[i]} * phi[i];
  }
  s = wide::round_shift(s, kRatioBits);
  FixedRigid out;
  const std::int64_t squared = wide::round_shift(s * s, kRatioBits);
  const std::int64_t cosine = (std::int64_t{1} << kRatioBits) - s / 8 + squared / 384;
  out.rotation[0] = FixedRatio::from_raw(wide::narrow(cosine, none));
  const std::int64_t half = (std::int64_t{1} << (kRatioBits - 1)) - s / 48 + squared / 3840;
  for (int i = 0; i < 3; ++i) {
    out.rotation[i + 1] = FixedRatio::from_raw(
        static_cast<std::int32_t>(wide::round_shift(phi[i] * half, kRatioBits)));
  }
  normalise(out.rotation);
  return out;
}

}  // namespace cairn
