#include <cstddef>
#include <initializer_list>

#include "cairn/numeric/math.hpp"
#include "cairn/vision/detail/patch_rows.hpp"
#include "cairn/vision/patch.hpp"

#include "patch_moments.hpp"

namespace cairn {
namespace {

#if defined(__ARM_FEATURE_SIMD32)
using vision::add_products;
using vision::Pair;
#endif

constexpr int kSide = vision::kPatchSide;
constexpr int kPadded = vision::kPaddedSide;
constexpr int kPaddedPitch = vision::kPaddedPitch;
constexpr int kMinPixels = kSide * kSide / 3;
constexpr std::int64_t kMinGradientSquare = 4;  // (2 grey values per pixel)^2
constexpr int kTemplateBits = 7;                // grey values are Q7 here, Q4 in the image

/// Inverse of the warp, Q16; false when it is not usable.
bool invert(const PatchWarp& warp, PatchWarp& inverse) {
  constexpr std::int32_t kMaxEntry = 16 << 16;
  for (const std::int32_t entry : {warp.xx, warp.xy, warp.yx, warp.yy}) {
    if (entry > kMaxEntry || entry < -kMaxEntry) return false;
  }
  const std::int64_t determinant = static_cast<std::int64_t>(warp.xx) * warp.yy -
                                   static_cast<std::int64_t>(warp.xy) * warp.yx;  // Q32
  constexpr std::int64_t kOne = std::int64_t{1} << 32;
  if (determinant < kOne / 8 || determinant > kOne * 8) return false;
  const auto divide = [&](std::int32_t value) {
    return static_cast<std::int32_t>(value * kOne / determinant);
  };
  inverse = {divide(warp.yy), divide(-warp.xy), divide(-warp.yx), divide(warp.xx)};
  return true;
}

/// Value at a fraction (fx, fy), 0..256, between four neighbours of the patch: Q7, zero at
/// mid-grey.
std::int16_t patch_value(const std::uint8_t* p, std::int32_t fx, std::int32_t fy) {
  const std::uint8_t* const below = p + Patch::kSize;
  constexpr int kShift = 16 - kTemplateBits;
  constexpr std::int32_t kRounding = 1 << (kShift - 1);
#if defined(__ARM_FEATURE_SIMD32)
  // Bytes times weights that add up to 256 stay below 2^16: both rows in one multiplication.
  const auto weight = static_cast<std::uint32_t>(fx);
  const std::uint32_t left = p[0] | static_cast<std::uint32_t>(below[0]) << 16U;
  const std::uint32_t right = p[1] | static_cast<std::uint32_t>(below[1]) << 16U;
  const Pair column = (left * (256U - weight) + right * weight) ^ 0x80008000U;
  return static_cast<std::int16_t>(
      add_products(column, vision::make_pair(256 - fy, fy), kRounding) >> kShift);
#else
  constexpr std::int32_t kMidGrey = 128 << 16;
  const std::int32_t top = (p[0] << 8) + (p[1] - p[0]) * fx;
  const std::int32_t bottom = (below[0] << 8) + (below[1] - below[0]) * fx;
  return static_cast<std::int16_t>(((top << 8) + (bottom - top) * fy - kMidGrey + kRounding) >>
                                   kShift);
#endif
}

/// Warped values around the patch's centre, Q7, zero at mid-grey and where the patch ends; a bit of
/// known[y] says which of a row's columns it covers.
void sample_patch(const Patch& patch, const PatchWarp& inverse, std::int16_t* padded,
                  std::uint32_t* known) {
  constexpr std::int32_t kCentre = Patch::kSize / 2 * 65536 + 128;
  constexpr std::uint32_t kLast = (Patch::kSize - 1) * 256;
  constexpr int kReach = kPadded / 2;
  constexpr std::uint32_t kAll = (1U << kPadded) - 1U;
  const auto lies_inside = [](std::int32_t x_q16, std::int32_t y_q16) {
    return static_cast<std::uint32_t>(x_q16 >> 8) < kLast &&
           static_cast<std::uint32_t>(y_q16 >> 8) < kLast;
  };
  const auto value_at = [&](std::int32_t x_q16, std::int32_t y_q16) {
    return patch_value(patch.pixels + (y_q16 >> 16) * Patch::kSize + (x_q16 >> 16),
                       x_q16 >> 8 & 255, y_q16 >> 8 & 255);
  };
  for (int y = 0; y < kPadded; ++y, padded += kPaddedPitch) {
    std::int32_t x_q16 = kCentre + inverse.xy * (y - kReach) - inverse.xx * kReach;
    std::int32_t y_q16 = kCentre + inverse.yy * (y - kReach) - inverse.yx * kReach;
    padded[kPadded] = 0;
    if (lies_inside(x_q16, y_q16) &&
        lies_inside(x_q16 + 2 * kReach * inverse.xx, y_q16 + 2 * kReach * inverse.yx)) {
      for (int x = 0; x < kPadded; ++x, x_q16 += inverse.xx, y_q16 += inverse.yx) {
        padded[x] = value_at(x_q16, y_q16);
      }
      known[y] = kAll;
      continue;
    }
    std::uint32_t flags = 0;
    for (int x = 0; x < kPadded; ++x, x_q16 += inverse.xx, y_q16 += inverse.yx) {
      std::int32_t column = x_q16 >> 16;
      std::int32_t row = y_q16 >> 16;
      std::int32_t fx = x_q16 >> 8 & 255;
      std::int32_t fy = y_q16 >> 8 & 255;
      const auto px = static_cast<std::uint32_t>(x_q16 >> 8);
      const auto py = static_cast<std::uint32_t>(y_q16 >> 8);
      padded[x] = 0;
      if (px >= kLast || py >= kLast) {
        if (px > kLast || py > kLast) continue;
        // The last row and column are reached from the pixel before them, so that all four
        // neighbours exist.
        if (px == kLast) {
          --column;
          fx = 256;
        }
        if (py == kLast) {
          --row;
          fy = 256;
        }
      }
      padded[x] = patch_value(patch.pixels + row * Patch::kSize + column, fx, fy);
      flags |= 1U << static_cast<unsigned>(x);
    }
    known[y] = flags;
  }
}

int count_bits(std::uint32_t bits) {
  int count = 0;
  for (; bits != 0; bits &= bits - 1) ++count;
  return count;
}

}  // namespace

bool PatchTemplate::solve(std::int64_t xx, std::int64_t xy, std::int64_t yy) {
  // Both eigenvalues above the limit: the matrix less the limit is positive definite.
  const std::int64_t limit = kMinGradientSquare * count_ << (2 * kTemplateBits);
  std::int64_t energy = energy_;
  int shift = 0;
  for (; ((xx | yy | energy) >> shift) >= (std::int64_t{1} << 24); ++shift) {
  }
  xx >>= shift;
  xy >>= shift;
  yy >>= shift;
  energy >>= shift;
  const std::int64_t weakest = limit >> shift;
  if (xx <= weakest || yy <= weakest || (xx - weakest) * (yy - weakest) <= xy * xy) return false;
  const std::int64_t determinant = xx * yy - xy * xy;
  solve_xx_ = (yy * energy << 12) / determinant;
  solve_xy_ = -((xy * energy) * 4096) / determinant;
  solve_yy_ = (xx * energy << 12) / determinant;
  return true;
}

bool PatchTemplate::build(const Patch& patch, const PatchWarp& warp) {
  PatchWarp inverse;
  if (!invert(warp, inverse)) return false;
  std::int16_t padded[kPadded * kPaddedPitch];
  std::uint32_t known[kPadded];
  sample_patch(patch, inverse, padded, known);
  count_ = 0;
  for (int y = 0; y < kSide; ++y) {
    // A pixel counts when the four beside it are known as well.
    const std::uint32_t row = known[y + 1];
    const std::uint32_t covered =
        (row >> 1U) & row & (row >> 2U) & (known[y] >> 1U) & (known[y + 2] >> 1U);
    covered_[y] = static_cast<std::uint16_t>(covered & ((1U << kSide) - 1U));
    count_ += count_bits(covered_[y]);
  }
  if (count_ < kMinPixels) return false;
  Moments moments = differentiate(padded);
  remove_mean(moments.value / count_, moments);
  if (energy_ == 0) return false;
  energy_root_ = integer_sqrt(static_cast<std::uint64_t>(energy_));
  return project_out_values(moments);
}

Status PatchTemplate::prepare(const Patch& patch, const PatchWarp& warp) {
  if (build(patch, warp)) return Status::kOk;
  count_ = 0;
  return Status::kDegenerate;
}

}  // namespace cairn
