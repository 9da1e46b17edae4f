#include "patch_moments.hpp"

#include <cstddef>

namespace cairn {
namespace {

#if defined(__ARM_FEATURE_SIMD32)
using vision::add_products;
using vision::load_pair;
using vision::Pair;
using vision::pair_mask;
using vision::store_pair;
using vision::subtract_pairs;
#endif

constexpr int kPaddedPitch = vision::kPaddedPitch;
constexpr std::int32_t kMaxRatio = 0x7FFF;

#if defined(__ARM_FEATURE_SIMD32)
constexpr Pair kOnes = 0x00010001U;

/// value - ratio_q14 * along, both values of a pair; |ratio| < 2 keeps it in 32 bits.
Pair subtract_part(Pair value, Pair along, std::int16_t ratio_q14) {
  const std::int32_t low = vision::low_half(along) * ratio_q14 + (1 << 13);
  const std::int32_t high = vision::high_half(along) * ratio_q14 + (1 << 13);
  return subtract_pairs(value, vision::shifted_pair<14>(low, high));
}
#endif

}  // namespace

#if defined(__ARM_FEATURE_SIMD32)

/// Values and gradients of the covered pixels, with their sums.
PatchTemplate::Moments PatchTemplate::differentiate(const std::int16_t* padded) {
  std::int32_t sum = 0;
  std::int32_t sum_x = 0;
  std::int32_t sum_y = 0;
  for (int y = 0; y < kSide; ++y) {
    const std::int16_t* const centre = padded + (y + 1) * kPaddedPitch + 1;
    const std::uint32_t flags = covered_[y];
    for (int x = 0; x < kPitch; x += 2) {
      const std::int16_t* const c = centre + x;
      const Pair mask = pair_mask(flags, x);
      const Pair value = load_pair(c) & mask;
      const Pair gx = vision::half_difference(load_pair(c + 1), load_pair(c - 1)) & mask;
      const Pair gy =
          vision::half_difference(load_pair(c + kPaddedPitch), load_pair(c - kPaddedPitch)) & mask;
      sum = add_products(value, kOnes, sum);
      sum_x = add_products(gx, kOnes, sum_x);
      sum_y = add_products(gy, kOnes, sum_y);
      store_pair(value_ + y * kPitch + x, value);
      store_pair(gradient_x_ + y * kPitch + x, gx);
      store_pair(gradient_y_ + y * kPitch + x, gy);
    }
  }
  Moments sums;
  sums.value = sum;
  sums.x = sum_x;
  sums.y = sum_y;
  return sums;
}

/// Makes the values zero-mean; sums their squares, and their products with the gradients.
void PatchTemplate::remove_mean(std::int32_t mean, Moments& moments) {
  const Pair means = vision::make_pair(mean, mean);
  std::int32_t sum = 0;
  std::int64_t energy = 0;
  std::int64_t value_x = 0;
  std::int64_t value_y = 0;
  for (int y = 0; y < kSide; ++y) {
    const std::uint32_t flags = covered_[y];
    for (int x = 0; x < kPitch; x += 2) {
      const int i = y * kPitch + x;
      const Pair value = subtract_pairs(load_pair(value_ + i), means & pair_mask(flags, x));
      store_pair(value_ + i, value);
      sum = add_products(value, kOnes, sum);
      energy = add_products(value, value, energy);
      value_x = add_products(load_pair(gradient_x_ + i), value, value_x);
      value_y = add_products(load_pair(gradient_y_ + i), value, value_y);
    }
  }
  value_sum_ = sum;
  energy_ = energy;
  moments.value_x = value_x;
  moments.value_y = value_y;
}

#else  // the same, value by value

PatchTemplate::Moments PatchTemplate::differentiate(const std::int16_t* padded) {
  Moments sums;
  int i = 0;
  for (int y = 0; y < kSide; ++y) {
    const std::int16_t* c = padded + (y + 1) * kPaddedPitch + 1;
    std::uint32_t flags = covered_[y];
    for (int x = 0; x < kPitch; ++x, ++i, ++c, flags >>= 1U) {
      value_[i] = gradient_x_[i] = gradient_y_[i] = 0;
      if ((flags & 1U) == 0) continue;
      const std::int32_t value = *c;
      const std::int32_t gx = (c[1] - c[-1]) / 2;
      const std::int32_t gy = (c[kPaddedPitch] - c[-kPaddedPitch]) / 2;
      sums.value += value;
      sums.x += gx;
      sums.y += gy;
      value_[i] = static_cast<std::int16_t>(value);
      gradient_x_[i] = static_cast<std::int16_t>(gx);
      gradient_y_[i] = static_cast<std::int16_t>(gy);
    }
  }
  return sums;
}

void PatchTemplate::remove_mean(std::int32_t mean, Moments& moments) {
  std::int32_t sum = 0;
  std::int64_t energy = 0;
  std::int64_t value_x = 0;
  std::int64_t value_y = 0;
  int i = 0;
  for (int y = 0; y < kSide; ++y) {
    std::uint32_t flags = covered_[y];
    for (int x = 0; x < kPitch; ++x, ++i, flags >>= 1U) {
      if ((flags & 1U) == 0) continue;
      const std::int32_t value = value_[i] - mean;
      value_[i] = static_cast<std::int16_t>(value);
      sum += value;
      energy += std::int64_t{value} * value;
      value_x += std::int64_t{gradient_x_[i]} * value;
      value_y += std::int64_t{gradient_y_[i]} * value;
    }
  }
  value_sum_ = sum;
  energy_ = energy;
  moments.value_x = value_x;
  moments.value_y = value_y;
}

#endif

/// Takes the mean and the part along the values out of the gradients, and solves for the step.
bool PatchTemplate::project_out_values(const Moments& moments) {
  const std::int32_t mean_x = moments.x / count_;
  const std::int32_t mean_y = moments.y / count_;
  constexpr std::int64_t kOne = 1 << 14;
  const std::int64_t ratio_x =
      (moments.value_x - static_cast<std::int64_t>(mean_x) * value_sum_) * kOne / energy_;
  const std::int64_t ratio_y =
      (moments.value_y - static_cast<std::int64_t>(mean_y) * value_sum_) * kOne / energy_;
  // Only a patch that is flat but for its rim goes beyond.
  if (ratio_x > kMaxRatio || ratio_x < -kMaxRatio || ratio_y > kMaxRatio || ratio_y < -kMaxRatio) {
    return false;
  }
  const auto along_x = static_cast<std::int16_t>(ratio_x);
  const auto along_y = static_cast<std::int16_t>(ratio_y);
  std::int64_t xx = 0;
  std::int64_t xy = 0;
  std::int64_t yy = 0;
#if defined(__ARM_FEATURE_SIMD32)
  const Pair means_x = vision::make_pair(mean_x, mean_x);
  const Pair means_y = vision::make_pair(mean_y, mean_y);
  for (int y = 0; y < kSide; ++y) {
    const std::uint32_t flags = covered_[y];
    for (int x = 0; x < kPitch; x += 2) {
      const int i = y * kPitch + x;
      const Pair mask = pair_mask(flags, x);
      const Pair value = load_pair(value_ + i);
      const Pair gx =
          subtract_part(subtract_pairs(load_pair(gradient_x_ + i), means_x & mask), value, along_x);
      const Pair gy =
          subtract_part(subtract_pairs(load_pair(gradient_y_ + i), means_y & mask), value, along_y);
      store_pair(gradient_x_ + i, gx);
      store_pair(gradient_y_ + i, gy);
      xx = add_products(gx, gx, xx);
      xy = add_products(gx, gy, xy);
      yy = add_products(gy, gy, yy);
    }
  }
#else
  const auto without = [](std::int32_t gradient, std::int32_t mean, std::int32_t value,
                          std::int32_t ratio_q14) {
    return static_cast<std::int16_t>(gradient - mean - ((value * ratio_q14 + (1 << 13)) >> 14));
  };
  int i = 0;
  for (int y = 0; y < kSide; ++y) {
    std::uint32_t flags = covered_[y];
    for (int x = 0; x < kPitch; ++x, ++i, flags >>= 1U) {
      if ((flags & 1U) == 0) continue;  // all are 0
      const std::int32_t value = value_[i];
      const std::int16_t gx = without(gradient_x_[i], mean_x, value, along_x);
      const std::int16_t gy = without(gradient_y_[i], mean_y, value, along_y);
      gradient_x_[i] = gx;
      gradient_y_[i] = gy;
      xx += std::int64_t{gx} * gx;
      xy += std::int64_t{gx} * gy;
      yy += std::int64_t{gy} * gy;
    }
  }
#endif
  return solve(xx, xy, yy);
}

}  // namespace cairn
