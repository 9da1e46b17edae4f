#include "cairn/tracking/fixed_warp.hpp"

#include "cairn/numeric/float_bits.hpp"
#include "cairn/numeric/reciprocal.hpp"

namespace cairn {
namespace {

constexpr int kBits = 24;  // of what follows from tangents

/// Sum of products of two rows with 28 fraction bits.
std::int32_t dot(const std::int32_t (&a)[3], const std::int32_t (&b)[3], std::uint32_t& lost) {
  std::int64_t sum = 0;
  for (int i = 0; i < 3; ++i) sum += std::int64_t{a[i]} * b[i] >> 2;
  return wide::narrow(wide::round_shift(sum, 2 * FixedTangent::kFractionBits - 2 - kBits), lost);
}

}  // namespace

/// With the rows R of the derivatives, without their factors f / z: (z_r / z_c) F (R_c R_cr R_r^T)
/// (R_r R_r^T)^-1 F^-1, F the focal lengths.
bool predict_patch_warp(const FixedCamera& camera, const FixedView& reference,
                        const FixedView& present, const detail::FixedRotation& R_camera_reference,
                        PatchWarp& warp) {
  constexpr int kWarpBits = 16;
  constexpr std::int64_t kMost = std::int64_t{8} << kWarpBits;
  if (reference.depth <= 0 || present.depth <= 0) return false;
  std::uint32_t lost = 0;
  std::int32_t rows[2][3];
  std::int32_t turned[2][3];
  for (int r = 0; r < 2; ++r) {
    for (int k = 0; k < 3; ++k) {
      rows[r][k] = reference.projection.rows[r][k].raw();
      std::int64_t sum = 0;
      for (int i = 0; i < 3; ++i) {
        sum +=
            std::int64_t{present.projection.rows[r][i].raw()} * R_camera_reference.r[i][k].raw() >>
            2;
      }
      turned[r][k] = wide::narrow(wide::round_shift(sum, FixedRatio::kFractionBits - 2), lost);
    }
  }
  const std::int32_t xx = dot(rows[0], rows[0], lost);
  const std::int32_t xy = dot(rows[0], rows[1], lost);
  const std::int32_t yy = dot(rows[1], rows[1], lost);
  const std::int32_t determinant =
      wide::narrow(wide::round_shift(std::int64_t{xx} * yy - std::int64_t{xy} * xy, kBits), lost);
  if (lost != 0 || determinant <= 0) return false;
  const Reciprocal over_determinant(determinant);
  const std::int32_t ratio =
      wide::narrow(Reciprocal(present.depth).times(reference.depth, kBits), lost);
  std::int64_t entries[2][2];
  for (int r = 0; r < 2; ++r) {
    const std::int64_t x = dot(turned[r], rows[0], lost);
    const std::int64_t y = dot(turned[r], rows[1], lost);
    const auto entry = [&](std::int64_t sum) {
      const std::int64_t solved =
          over_determinant.times(wide::narrow(wide::round_shift(sum, kBits), lost), kBits);
      return wide::multiply(solved, ratio, 2 * kBits - kWarpBits, lost);
    };
    entries[r][0] = entry(x * yy - y * xy);
    entries[r][1] = entry(y * xx - x * xy);
  }
  if (camera.fx != camera.fy) {
    entries[0][1] = wide::divide(wide::multiply(entries[0][1], camera.fx.raw(), 0, lost),
                                 camera.fy.raw(), 0, lost);
    entries[1][0] = wide::divide(wide::multiply(entries[1][0], camera.fy.raw(), 0, lost),
                                 camera.fx.raw(), 0, lost);
  }
  if (lost != 0) return false;
  for (const auto& row : entries) {
    for (const std::int64_t entry : row) {
      if (entry >= kMost || entry <= -kMost) return false;
    }
  }
  warp.xx = static_cast<std::int32_t>(entries[0][0]);
  warp.xy = static_cast<std::int32_t>(entries[0][1]);
  warp.yx = static_cast<std::int32_t>(entries[1][0]);
  warp.yy = static_cast<std::int32_t>(entries[1][1]);
  return true;
}

Matrix2<float> matrix_of(const PatchWarp& warp) {
  const auto entry = [](std::int32_t raw) {
    return float_of(Fixed<std::int32_t, 16>::from_raw(raw));
  };
  Matrix2<float> out;
  out << entry(warp.xx), entry(warp.xy), entry(warp.yx), entry(warp.yy);
  return out;
}

}  // namespace cairn
