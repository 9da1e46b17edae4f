#include "cairn/vision/patch.hpp"

#include <cstddef>
#include <cstring>

#include "cairn/numeric/math.hpp"
#include "cairn/vision/detail/patch_rows.hpp"

namespace cairn {
namespace {

using vision::RowSampler;
#if defined(__ARM_FEATURE_SIMD32)
using vision::add_products;
using vision::for_each_pair;
using vision::load_pair;
using vision::Pair;
using vision::pair_mask;
#endif

constexpr int kHalf = 5;
constexpr int kSide = vision::kPatchSide;
constexpr int kPitch = vision::kRowPitch;
constexpr int kMaxIterations = 8;
constexpr int kMaxStep = 256;       // 1 px
constexpr int kConvergedStep = 8;   // 1/32 px
constexpr int kFinestStep = 1;      // no use in going on
constexpr int kMaxShift = 2 * 256;  // 2 px
#if defined(__ARM_FEATURE_SIMD32)
constexpr Pair kOnes = 0x00010001U;
#endif

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

int magnitude(int v) {
  return v < 0 ? -v : v;
}

bool inside(const ImageView& image, int x_q8, int y_q8) {
  return window_fits(x_q8, kHalf, image.width) && window_fits(y_q8, kHalf, image.height);
}

}  // namespace

struct PatchTemplate::Response {
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t gain = 0;
};

#if defined(__ARM_FEATURE_SIMD32)

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

#else

/// Value by value: what is interpolated is not stored.
PatchTemplate::Response PatchTemplate::respond(const ImageView& image, int x_q8, int y_q8) const {
  Response response;
  const RowSampler sampler(x_q8 & 255, y_q8 & 255, image.stride);
  const std::uint8_t* p = image.row((y_q8 >> 8) - kHalf) + (x_q8 >> 8) - kHalf;
  for (int row = 0; row < kSide; ++row, p += image.stride) {
    const std::int16_t* const weights_x = gradient_x_ + row * kPitch;
    const std::int16_t* const weights_y = gradient_y_ + row * kPitch;
    const std::int16_t* const weights = value_ + row * kPitch;
    // A row fits into 32 bits: 11 * 2^15 * 2^11.
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::int32_t gain = 0;
    sampler.visit(
        p, [&](int column, std::int32_t value) __attribute__((always_inline)) {
          x += weights_x[column] * value;
          y += weights_y[column] * value;
          gain += weights[column] * value;
        });
    response.x += x;
    response.y += y;
    response.gain += gain;
  }
  return response;
}

#endif

/// Displacement of the window from the best position, in 1/256 px, at most kMaxStep in each
/// direction. False when the window does not look like the template at all.
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
#if defined(__ARM_FEATURE_SIMD32)
    for_each_pair([&](int column) {
      const Pair value = load_pair(values + column) & pair_mask(flags, column);
      sum = add_products(value, kOnes, sum);
      row_squares = add_products(value, value, row_squares);
      row_product = add_products(load_pair(value_ + row * kPitch + column), value, row_product);
    });
#else
    const std::int16_t* const weights = value_ + row * kPitch;
    for (int column = 0; column < kSide; ++column) {
      if ((flags >> static_cast<unsigned>(column) & 1U) == 0) continue;
      const std::int32_t value = values[column];
      sum += value;
      row_squares += value * value;
      row_product += weights[column] * value;
    }
#endif
    squares += row_squares;
    product += row_product;
  });
  const std::int64_t variance = squares - static_cast<std::int64_t>(sum) * sum / count_;  // Q8
  if (variance <= 0) return 0;
  // The values have zero mean up to rounding; what is left of it meets the image's mean here.
  product -= static_cast<std::int64_t>(value_sum_) * sum / count_;
  const std::int64_t norm = static_cast<std::int64_t>(energy_root_) *
                            integer_sqrt(static_cast<std::uint64_t>(variance));  // Q11
  if (norm == 0) return 0;
  const std::int64_t correlation = product * 1024 / norm;
  return static_cast<int>(correlation > 1024 ? 1024 : correlation < -1024 ? -1024 : correlation);
}

Status extract_patch(const ImageView& image, int x_q8, int y_q8, Patch& patch) {
  if (!image.valid()) return Status::kInvalidArgument;
  constexpr int kReach = Patch::kSize / 2;
  if (!window_fits(x_q8, kReach, image.width) || !window_fits(y_q8, kReach, image.height)) {
    return Status::kOutOfView;
  }
  const std::uint8_t* row = image.row((y_q8 >> 8) - kReach) + (x_q8 >> 8) - kReach;
  std::uint8_t* out = patch.pixels;
  if (((x_q8 | y_q8) & 255) == 0) {
    for (int y = 0; y < Patch::kSize; ++y, row += image.stride, out += Patch::kSize) {
      std::memcpy(out, row, Patch::kSize);
    }
    return Status::kOk;
  }
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
