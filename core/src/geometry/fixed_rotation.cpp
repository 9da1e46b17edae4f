#include "cairn/geometry/fixed_camera.hpp"

namespace cairn::detail {
namespace {

using Count = std::uint32_t;

/// Sum of three products with 30 fraction bits, in the format of the second factors.
std::int64_t sum_of(const FixedRatio (&a)[3], std::int64_t x, std::int64_t y, std::int64_t z) {
  return wide::round_shift(a[0].raw() * x + a[1].raw() * y + a[2].raw() * z,
                           FixedRatio::kFractionBits);
}

}  // namespace

FixedRotation FixedRotation::operator*(const FixedRotation& other) const {
  FixedRotation out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const std::int64_t sum =
          sum_of(r[i], other.r[0][j].raw(), other.r[1][j].raw(), other.r[2][j].raw());
      out.r[i][j] = FixedRatio::from_raw(static_cast<std::int32_t>(sum));
    }
  }
  return out;
}

FixedRotation FixedRotation::transposed() const {
  FixedRotation out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out.r[i][j] = r[j][i];
  }
  return out;
}

void FixedRotation::turn(const FixedLength (&v)[3], FixedLength (&out)[3],
                         Count& saturations) const {
  for (int i = 0; i < 3; ++i) {
    out[i] = FixedLength::from_raw(
        wide::narrow(sum_of(r[i], v[0].raw(), v[1].raw(), v[2].raw()), saturations));
  }
}

FixedRotation rotation_of(const FixedMount& mount) {
  Count none = 0;
  const auto product = [&](FixedRatio a, FixedRatio b) {
    return std::int64_t{multiply<FixedRatio>(a, b, none).raw()};
  };
  constexpr std::int64_t kOne = std::int64_t{1} << FixedRatio::kFractionBits;
  const FixedRatio w = mount.w;
  const FixedRatio x = mount.x;
  const FixedRatio y = mount.y;
  const FixedRatio z = mount.z;
  const auto entry = [&](std::int64_t value) {
    return FixedRatio::from_raw(wide::narrow(value, none));
  };
  const auto diagonal = [&](FixedRatio a, FixedRatio b) {
    return entry(kOne - 2 * (product(a, a) + product(b, b)));
  };
  const auto other = [&](FixedRatio a, FixedRatio b, FixedRatio c, int sign) {
    return entry(2 * (product(a, b) + sign * product(w, c)));
  };
  FixedRotation out;
  out.r[0][0] = diagonal(y, z);
  out.r[0][1] = other(x, y, z, -1);
  out.r[0][2] = other(x, z, y, 1);
  out.r[1][0] = other(x, y, z, 1);
  out.r[1][1] = diagonal(x, z);
  out.r[1][2] = other(y, z, x, -1);
  out.r[2][0] = other(x, z, y, -1);
  out.r[2][1] = other(y, z, x, 1);
  out.r[2][2] = diagonal(x, y);
  return out;
}

FixedRotation rotation_about_vertical(FixedRatio cosine, FixedRatio sine) {
  FixedRotation out;
  out.r[0][0] = cosine;
  out.r[0][1] = -sine;
  out.r[1][0] = sine;
  out.r[1][1] = cosine;
  return out;
}

}  // namespace cairn::detail
