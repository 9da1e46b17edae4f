#include "cairn/planar/fixed/covariance3.hpp"

namespace cairn::detail {
namespace {

using Count = std::uint32_t;
constexpr int kBits = FixedCholesky3::kBits;
constexpr int kVarianceBits = FixedVariance::kFractionBits;

std::int64_t root_of(std::int64_t variance, Count& count) {
  const FixedRoot root = square_root(variance, kVarianceBits);
  return wide::scale(root.mantissa, kBits - root.bits, count);
}

}  // namespace

FixedCovariance3 turned(const FixedCovariance3& covariance, const FixedRotation& rotation,
                        Count& saturations) {
  const FixedVariance c[3][3] = {{covariance.xx, covariance.xy, covariance.xz},
                                 {covariance.xy, covariance.yy, covariance.yz},
                                 {covariance.xz, covariance.yz, covariance.zz}};
  FixedVariance half[3][3];  // R C
  const auto sum_of = [&](const FixedRatio(&a)[3], FixedVariance x, FixedVariance y,
                          FixedVariance z) {
    const FixedVariance terms[3] = {multiply<FixedVariance>(x, a[0], saturations),
                                    multiply<FixedVariance>(y, a[1], saturations),
                                    multiply<FixedVariance>(z, a[2], saturations)};
    return add(add(terms[0], terms[1], saturations), terms[2], saturations);
  };
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      half[i][j] = sum_of(rotation.r[i], c[0][j], c[1][j], c[2][j]);
    }
  }
  const auto entry = [&](int i, int j) {
    return sum_of(rotation.r[j], half[i][0], half[i][1], half[i][2]);
  };
  return {entry(0, 0), entry(1, 0), entry(1, 1), entry(2, 0), entry(2, 1), entry(2, 2)};
}

bool cholesky(const FixedCovariance3& covariance, FixedCholesky3& out, Count& saturations) {
  constexpr int kSquared = 2 * kBits - kVarianceBits;
  std::int64_t* const l = out.l;
  const auto less = [&](FixedVariance value, std::int64_t a, std::int64_t b) {
    return wide::add(value.raw(), -wide::multiply(a, b, kSquared, saturations), saturations);
  };
  const auto over = [&](std::int64_t value, std::int64_t root) {
    return wide::divide(value, root, kSquared, saturations);
  };
  if (covariance.xx.raw() <= 0) return false;
  l[0] = root_of(covariance.xx.raw(), saturations);
  l[1] = over(covariance.xy.raw(), l[0]);
  const std::int64_t second = less(covariance.yy, l[1], l[1]);
  if (second <= 0) return false;
  l[2] = root_of(second, saturations);
  l[3] = over(covariance.xz.raw(), l[0]);
  l[4] = over(less(covariance.yz, l[3], l[1]), l[2]);
  const std::int64_t third =
      less(FixedVariance::from_raw(less(covariance.zz, l[3], l[3])), l[4], l[4]);
  if (third <= 0) return false;
  l[5] = root_of(third, saturations);
  return true;
}

}  // namespace cairn::detail
