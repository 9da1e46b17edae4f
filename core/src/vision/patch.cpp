#include "cairn/vision/patch.hpp"

#include <cstddef>
#include <initializer_list>

#include "cairn/vision/detail/patch_rows.hpp"

namespace cairn {
namespace {

using vision::add_products;
using vision::for_each_pair;
using vision::load_pair;
using vision::Pair;
using vision::pair_mask;
using vision::RowSampler;
using vision::store_pair;
using vision::subtract_pairs;

constexpr int kHalf = 5;
constexpr int kSide = vision::kPatchSide;
constexpr int kPitch = vision::kRowPitch;
constexpr int kPixels = kSide * kSide;
constexpr int kPadded = kSide + 2;         // one more on each side, for gradients
constexpr int kPaddedPitch = kPadded + 1;  // whole pairs
constexpr int kMaxIterations = 8;
constexpr int kMaxStep = 256;       // 1 px
constexpr int kConvergedStep = 8;   // 1/32 px
constexpr int kFinestStep = 1;      // no use in going on
constexpr int kMaxShift = 2 * 256;  // 2 px
constexpr int kMinPixels = kPixels / 3;
constexpr std::int64_t kMinGradientSquare = 4;  // (2 grey values per pixel)^2
constexpr std::int32_t kMaxRatio = 0x7FFF;
constexpr Pair kOnes = 0x00010001U;

/// Grey values are Q7 in the template and Q4 in the image.
constexpr int kTemplateBits = 7;

/// Weighted sum of four neighbours, Q16, at a fraction (fx, fy) in 1/256 pixel beyond `p`. A
/// neighbour whose weight is zero is not read.
int bilinear_q16(const std::uint8_t* p, std::ptrdiff_t stride, int fx, int fy) {
  const int right = fx != 0 ? 1 : 0;
  const std::uint8_t* const below = fy != 0 ? p + stride : p;
  const int top = p[0] * (256 - fx) + p[right] * fx;
  const int bottom = below[0] * (256 - fx) + below[right] * fx;
  return top * (256 - fy) + bottom * fy;
}

/// True when pixels from floor(centre) - reach to ceil(centre) + reach exist.
bool window_fits(int centre_q8, int reach, int extent) {
  return centre_q8 >= reach * 256 && centre_q8 <= (extent - 1 - reach) * 256;
}

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
  // Bytes times weights that add up to 256 stay below 2^16: both rows in one multiplication.
  const auto weight = static_cast<std::uint32_t>(fx);
  const std::uint8_t* const below = p + Patch::kSize;
  const std::uint32_t left = p[0] | static_cast<std::uint32_t>(below[0]) << 16U;
  const std::uint32_t right = p[1] | static_cast<std::uint32_t>(below[1]) << 16U;
  const Pair column = (left * (256U - weight) + right * weight) ^ 0x80008000U;
  constexpr int kShift = 16 - kTemplateBits;
  constexpr std::int32_t kRounding = 1 << (kShift - 1);
  return static_cast<std::int16_t>(
      add_products(column, vision::make_pair(256 - fy, fy), kRounding) >> kShift);
}

/// Warped values around the patch's centre, Q7, zero at mid-grey and where the patch ends; a bit of
/// known[y] says which of a row's columns it covers.
void sample_patch(const Patch& patch, const PatchWarp& inverse, std::int16_t* padded,
                  std::uint32_t* known) {
  constexpr std::int32_t kCentre = Patch::kSize / 2 * 65536 + 128;
  constexpr std::uint32_t kLast = (Patch::kSize - 1) * 256;
  constexpr int kReach = kPadded / 2;
  for (int y = 0; y < kPadded; ++y, padded += kPaddedPitch) {
    std::int32_t x_q16 = kCentre + inverse.xy * (y - kReach) - inverse.xx * kReach;
    std::int32_t y_q16 = kCentre + inverse.yy * (y - kReach) - inverse.yx * kReach;
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
    padded[kPadded] = 0;
    known[y] = flags;
  }
}

int count_bits(std::uint32_t bits) {
  int count = 0;
  for (; bits != 0; bits &= bits - 1) ++count;
  return count;
}

std::uint32_t square_root(std::uint64_t value) {
  if (value == 0) return 0;
  std::uint64_t root = 0;
  const int highest = (63 - __builtin_clzll(value)) / 2;
  for (std::uint64_t bit = std::uint64_t{1} << highest; bit != 0; bit >>= 1) {
    const std::uint64_t trial = root | bit;
    if (trial * trial <= value) root = trial;
  }
  return static_cast<std::uint32_t>(root);
}

/// value - ratio_q14 * along, both values of a pair; |ratio| < 2 keeps it in 32 bits.
Pair subtract_part(Pair value, Pair along, std::int16_t ratio_q14) {
  const std::int32_t low = vision::low_half(along) * ratio_q14 + (1 << 13);
  const std::int32_t high = vision::high_half(along) * ratio_q14 + (1 << 13);
  return subtract_pairs(value, vision::shifted_pair<14>(low, high));
}

/// Visits the rows of the window around a position: f(row, values in Q4, zero at mid-grey).
template <class F>
__attribute__((always_inline)) inline void for_each_row(const ImageView& image, int x_q8, int y_q8,
                                                        F f) {
  const RowSampler sampler(x_q8 & 255, y_q8 & 255, image.stride);
  const std::uint8_t* p = image.row((y_q8 >> 8) - kHalf) + (x_q8 >> 8) - kHalf;
  std::int16_t values[kPitch] = {};
  for (int y = 0; y < kSide; ++y, p += image.stride) {
    sampler.sample(p, values);
    f(y, values);
  }
}

int bounded_step(std::int64_t numerator, std::int64_t denominator) {
  if (numerator >= kMaxStep * denominator) return kMaxStep;
  if (numerator <= -kMaxStep * denominator) return -kMaxStep;
  const std::int64_t half = numerator < 0 ? -denominator / 2 : denominator / 2;
  return static_cast<int>((numerator + half) / denominator);
}

}  // namespace

struct PatchTemplate::Moments {
  std::int32_t value = 0;
  std::int32_t x = 0;
  std::int32_t y = 0;
  std::int64_t value_x = 0;
  std::int64_t value_y = 0;
};

struct PatchTemplate::Response {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t gain = 0;
};

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
  const Pair means_x = vision::make_pair(mean_x, mean_x);
  const Pair means_y = vision::make_pair(mean_y, mean_y);
  std::int64_t xx = 0;
  std::int64_t xy = 0;
  std::int64_t yy = 0;
  for (int y = 0; y < kSide; ++y) {
    const std::uint32_t flags = covered_[y];
    for (int x = 0; x < kPitch; x += 2) {
      const int i = y * kPitch + x;
      const Pair mask = pair_mask(flags, x);
      const Pair value = load_pair(value_ + i);
      const Pair gx = subtract_part(subtract_pairs(load_pair(gradient_x_ + i), means_x & mask),
                                    value, static_cast<std::int16_t>(ratio_x));
      const Pair gy = subtract_part(subtract_pairs(load_pair(gradient_y_ + i), means_y & mask),
                                    value, static_cast<std::int16_t>(ratio_y));
      store_pair(gradient_x_ + i, gx);
      store_pair(gradient_y_ + i, gy);
      xx = add_products(gx, gx, xx);
      xy = add_products(gx, gy, xy);
      yy = add_products(gy, gy, yy);
    }
  }
  return solve(xx, xy, yy);
}

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
  energy_root_ = square_root(static_cast<std::uint64_t>(energy_));
  return project_out_values(moments);
}

Status PatchTemplate::prepare(const Patch& patch, const PatchWarp& warp) {
  if (build(patch, warp)) return Status::kOk;
  count_ = 0;
  return Status::kDegenerate;
}

PatchTemplate::Response PatchTemplate::respond(const ImageView& image, int x_q8, int y_q8) const {
  Response response;
  for_each_row(image, x_q8, y_q8, [&](int row, const std::int16_t* values) {
    // A row fits into 32 bits: 11 * 2^15 * 2^11.
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::int32_t gain = 0;
    for_each_pair([&](int column) {
      const int i = row * kPitch + column;
      const Pair value = load_pair(values + column);
      x = add_products(load_pair(gradient_x_ + i), value, x);
      y = add_products(load_pair(gradient_y_ + i), value, y);
      gain = add_products(load_pair(value_ + i), value, gain);
    });
    response.x += x;
    response.y += y;
    response.gain += gain;
  });
  return response;
}

/// Displacement of the window from the best position, in 1/256 px, at most kMaxStep each way. False
/// when the window does not look like the template at all.
bool PatchTemplate::step(const Response& response, int& dx_q8, int& dy_q8) const {
  if (response.gain <= 0) return false;
  // Q12 matrix times Q11 responses over the Q11 gain: Q12, wanted Q8.
  dx_q8 = bounded_step((solve_xx_ * response.x + solve_xy_ * response.y) >> 4, response.gain);
  dy_q8 = bounded_step((solve_xy_ * response.x + solve_yy_ * response.y) >> 4, response.gain);
  return true;
}

int PatchTemplate::correlation_q10(const ImageView& image, int x_q8, int y_q8) const {
  std::int32_t sum = 0;
  std::int64_t squares = 0;
  std::int64_t product = 0;
  for_each_row(image, x_q8, y_q8, [&](int row, const std::int16_t* values) {
    const std::uint32_t flags = covered_[row];
    std::int32_t row_squares = 0;
    std::int32_t row_product = 0;
    for_each_pair([&](int column) {
      const Pair value = load_pair(values + column) & pair_mask(flags, column);
      sum = add_products(value, kOnes, sum);
      row_squares = add_products(value, value, row_squares);
      row_product = add_products(load_pair(value_ + row * kPitch + column), value, row_product);
    });
    squares += row_squares;
    product += row_product;
  });
  const std::int64_t variance = squares - static_cast<std::int64_t>(sum) * sum / count_;  // Q8
  if (variance <= 0) return 0;
  // The values have zero mean up to rounding; what is left of it meets the image's mean here.
  product -= static_cast<std::int64_t>(value_sum_) * sum / count_;
  const std::int64_t norm = static_cast<std::int64_t>(energy_root_) *
                            square_root(static_cast<std::uint64_t>(variance));  // Q11
  if (norm == 0) return 0;
  const std::int64_t correlation = product * 1024 / norm;
  return static_cast<int>(correlation > 1024 ? 1024 : correlation < -1024 ? -1024 : correlation);
}

namespace {

int magnitude(int v) {
  return v < 0 ? -v : v;
}

bool inside(const ImageView& image, int x_q8, int y_q8) {
  return window_fits(x_q8, kHalf, image.width) && window_fits(y_q8, kHalf, image.height);
}

}  // namespace

Status extract_patch(const ImageView& image, int x_q8, int y_q8, Patch& patch) {
  if (!image.valid()) return Status::kInvalidArgument;
  constexpr int kReach = Patch::kSize / 2;
  if (!window_fits(x_q8, kReach, image.width) || !window_fits(y_q8, kReach, image.height)) {
    return Status::kOutOfView;
  }
  const std::uint8_t* row = image.row((y_q8 >> 8) - kReach) + (x_q8 >> 8) - kReach;
  std::uint8_t* out = patch.pixels;
  for (int y = 0; y < Patch::kSize; ++y, row += image.stride) {
    for (int x = 0; x < Patch::kSize; ++x) {
      const int value = bilinear_q16(row + x, image.stride, x_q8 & 255, y_q8 & 255);
      *out++ = static_cast<std::uint8_t>((value + (1 << 15)) >> 16);
    }
  }
  return Status::kOk;
}

Status align_patch(const ImageView& image, const Patch& patch, const PatchWarp& warp, int& x_q8,
                   int& y_q8, PatchAlignment& report) {
  report = {};
  if (!image.valid()) return Status::kInvalidArgument;
  if (!inside(image, x_q8, y_q8)) return Status::kOutOfView;
  PatchTemplate reference;
  if (const Status status = reference.prepare(patch, warp); !ok(status)) return status;
  return align_patch(image, reference, x_q8, y_q8, report);
}

Status align_patch(const ImageView& image, const PatchTemplate& reference, int& x_q8, int& y_q8,
                   PatchAlignment& report) {
  report = {};
  if (!image.valid()) return Status::kInvalidArgument;
  if (!inside(image, x_q8, y_q8)) return Status::kOutOfView;
  if (reference.count_ == 0) return Status::kDegenerate;
  int x = x_q8;
  int y = y_q8;
  PatchAlignment result;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    int dx = 0;
    int dy = 0;
    result.converged = false;
    if (!reference.step(reference.respond(image, x, y), dx, dy)) break;
    x -= dx;
    y -= dy;
    ++result.iterations;
    if (!inside(image, x, y)) return Status::kOutOfView;
    if (magnitude(x - x_q8) > kMaxShift || magnitude(y - y_q8) > kMaxShift) break;
    result.converged = magnitude(dx) <= kConvergedStep && magnitude(dy) <= kConvergedStep;
    if (magnitude(dx) <= kFinestStep && magnitude(dy) <= kFinestStep) break;
  }
  result.shift_x_q8 = static_cast<std::int16_t>(x - x_q8);
  result.shift_y_q8 = static_cast<std::int16_t>(y - y_q8);
  if (result.converged) {
    x_q8 = x;
    y_q8 = y;
  }
  result.correlation = static_cast<std::int16_t>(reference.correlation_q10(image, x_q8, y_q8));
  report = result;
  return Status::kOk;
}

}  // namespace cairn
