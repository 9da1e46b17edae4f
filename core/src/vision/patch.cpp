#include "cairn/vision/patch.hpp"

#include <cstddef>
#include <initializer_list>

namespace cairn {
namespace {

constexpr int kHalf = 5;
constexpr int kSide = 2 * kHalf + 1;
constexpr int kPixels = kSide * kSide;
constexpr int kPadded = kSide + 2;  // one more on each side, for gradients
constexpr int kMaxIterations = 8;
constexpr int kMaxStep = 256;       // 1 px
constexpr int kConvergedStep = 8;   // 1/32 px
constexpr int kFinestStep = 1;      // no use in going on
constexpr int kMaxShift = 2 * 256;  // 2 px
constexpr int kMinPixels = kPixels / 3;
constexpr std::int64_t kMinGradientSquare = 4;  // (2 grey values per pixel)^2
constexpr int kUnknown = -1;                    // grey value of what the patch does not cover

/// Grey values are Q7 in the template and Q4 in the image.
constexpr int kTemplateBits = 7;
constexpr int kImageBits = 4;

/// Bilinear value at a fraction (fx, fy) in 1/256 pixel beyond `p`, Q16. A neighbour whose weight
/// is zero is not read.
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

/// The patch as it should look in the image: zero-mean values, and gradients with the part along
/// the values and along a constant taken out, so that gain and offset do not disturb the
/// translation. Pixels that the patch does not cover are zero and not counted.
class Template {
 public:
  /// False when it does not determine a translation.
  bool build(const Patch& patch, const PatchWarp& warp);

  /// Correlations of an image window with the template. `gain` is scaled by the template's energy.
  struct Response {
    std::int64_t x = 0;
    std::int64_t y = 0;
    std::int64_t gain = 0;
  };
  Response respond(const ImageView& image, int x_q8, int y_q8) const;

  /// Displacement of the window from the best position, in 1/256 px, at most kMaxStep each way.
  /// False when the window does not look like the template at all.
  bool step(const Response& response, int& dx_q8, int& dy_q8) const;

  int correlation_q10(const ImageView& image, int x_q8, int y_q8) const;

 private:
  void sample(const Patch& patch, const PatchWarp& inverse, std::int16_t* padded) const;
  void remove_mean(std::int16_t* values);
  void project_out_values(std::int16_t* gradient);
  std::int64_t dot(const std::int16_t* a, const std::int16_t* b) const;

  std::int16_t value_[kPixels];
  std::int16_t gradient_x_[kPixels];
  std::int16_t gradient_y_[kPixels];
  bool covered_[kPixels];
  int count_ = 0;
  std::int64_t energy_ = 0;  // sum of squared values, Q14
  // energy * inverse of the gradients' Gram matrix, Q12
  std::int64_t solve_xx_ = 0;
  std::int64_t solve_xy_ = 0;
  std::int64_t solve_yy_ = 0;
};

void Template::sample(const Patch& patch, const PatchWarp& inverse, std::int16_t* padded) const {
  constexpr int kCentre = Patch::kSize / 2;
  constexpr std::int32_t kLast = (Patch::kSize - 1) * 256;
  for (int y = 0; y < kPadded; ++y) {
    for (int x = 0; x < kPadded; ++x) {
      const std::int32_t dx = x - kPadded / 2;
      const std::int32_t dy = y - kPadded / 2;
      const std::int32_t px = kCentre * 256 + ((inverse.xx * dx + inverse.xy * dy + 128) >> 8);
      const std::int32_t py = kCentre * 256 + ((inverse.yx * dx + inverse.yy * dy + 128) >> 8);
      std::int16_t& out = padded[y * kPadded + x];
      if (px < 0 || py < 0 || px > kLast || py > kLast) {
        out = kUnknown;
        continue;
      }
      const std::uint8_t* const p = patch.pixels + (py >> 8) * Patch::kSize + (px >> 8);
      constexpr int kShift = 16 - kTemplateBits;
      out = static_cast<std::int16_t>(
          (bilinear_q16(p, Patch::kSize, px & 255, py & 255) + (1 << (kShift - 1))) >> kShift);
    }
  }
}

std::int64_t Template::dot(const std::int16_t* a, const std::int16_t* b) const {
  std::int64_t sum = 0;
  for (int i = 0; i < kPixels; ++i) sum += static_cast<std::int32_t>(a[i]) * b[i];
  return sum;
}

void Template::remove_mean(std::int16_t* values) {
  std::int32_t sum = 0;
  for (int i = 0; i < kPixels; ++i) sum += covered_[i] ? values[i] : 0;
  const std::int32_t mean = sum / count_;
  for (int i = 0; i < kPixels; ++i) {
    values[i] = covered_[i] ? static_cast<std::int16_t>(values[i] - mean) : std::int16_t{0};
  }
}

void Template::project_out_values(std::int16_t* gradient) {
  remove_mean(gradient);
  // |ratio| is at most 2^15: gradients are half differences of the values.
  const auto ratio_q14 = static_cast<std::int32_t>(dot(gradient, value_) * (1 << 14) / energy_);
  for (int i = 0; i < kPixels; ++i) {
    const std::int64_t along = static_cast<std::int64_t>(ratio_q14) * value_[i];
    gradient[i] = static_cast<std::int16_t>(gradient[i] - ((along + (1 << 13)) >> 14));
  }
}

bool Template::build(const Patch& patch, const PatchWarp& warp) {
  PatchWarp inverse;
  if (!invert(warp, inverse)) return false;
  std::int16_t padded[kPadded * kPadded];
  sample(patch, inverse, padded);
  count_ = 0;
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const std::int16_t* const c = padded + (y + 1) * kPadded + x + 1;
      const int i = y * kSide + x;
      covered_[i] = c[0] != kUnknown && c[-1] != kUnknown && c[1] != kUnknown &&
                    c[-kPadded] != kUnknown && c[kPadded] != kUnknown;
      count_ += covered_[i] ? 1 : 0;
      // Half the range of Q7 greys lies below zero, so that they fit into 16 bits.
      value_[i] = static_cast<std::int16_t>(covered_[i] ? c[0] - (128 << kTemplateBits) : 0);
      gradient_x_[i] = static_cast<std::int16_t>(covered_[i] ? (c[1] - c[-1]) / 2 : 0);
      gradient_y_[i] = static_cast<std::int16_t>(covered_[i] ? (c[kPadded] - c[-kPadded]) / 2 : 0);
    }
  }
  if (count_ < kMinPixels) return false;
  remove_mean(value_);
  energy_ = dot(value_, value_);
  if (energy_ == 0) return false;
  project_out_values(gradient_x_);
  project_out_values(gradient_y_);
  std::int64_t xx = dot(gradient_x_, gradient_x_);
  std::int64_t xy = dot(gradient_x_, gradient_y_);
  std::int64_t yy = dot(gradient_y_, gradient_y_);
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

/// Visits the rows of the window: f(index of the row's first pixel, values in Q4, zero at
/// mid-grey). A row or column whose weight is zero is not read.
template <class F>
void for_each_row(const ImageView& image, int x_q8, int y_q8, F f) {
  const int fx = x_q8 & 255;
  const int fy = y_q8 & 255;
  const int last = fx != 0 ? kSide : kSide - 1;
  const std::ptrdiff_t down = fy != 0 ? image.stride : 0;
  const std::uint8_t* row = image.row((y_q8 >> 8) - kHalf) + (x_q8 >> 8) - kHalf;
  constexpr int kShift = 16 - kImageBits;
  constexpr int kOffset = (1 << (kShift - 1)) - (128 << 16);
  std::int32_t column[kSide + 1];
  std::int32_t values[kSide];
  column[kSide] = 0;
  for (int y = 0; y < kSide; ++y, row += image.stride) {
    for (int x = 0; x <= last; ++x) column[x] = (row[x] << 8) + (row[x + down] - row[x]) * fy;
    for (int x = 0; x < kSide; ++x) {
      values[x] = ((column[x] << 8) + (column[x + 1] - column[x]) * fx + kOffset) >> kShift;
    }
    f(y * kSide, values);
  }
}

Template::Response Template::respond(const ImageView& image, int x_q8, int y_q8) const {
  Response response;
  for_each_row(image, x_q8, y_q8, [&](int first, const std::int32_t* values) {
    // A row fits into 32 bits: 11 * 2^15 * 2^11.
    std::int32_t x = 0;
    std::int32_t y = 0;
    std::int32_t gain = 0;
    for (int i = 0; i < kSide; ++i) {
      x += gradient_x_[first + i] * values[i];
      y += gradient_y_[first + i] * values[i];
      gain += value_[first + i] * values[i];
    }
    response.x += x;
    response.y += y;
    response.gain += gain;
  });
  return response;
}

int bounded_step(std::int64_t numerator, std::int64_t denominator) {
  if (numerator >= kMaxStep * denominator) return kMaxStep;
  if (numerator <= -kMaxStep * denominator) return -kMaxStep;
  const std::int64_t half = numerator < 0 ? -denominator / 2 : denominator / 2;
  return static_cast<int>((numerator + half) / denominator);
}

bool Template::step(const Response& response, int& dx_q8, int& dy_q8) const {
  if (response.gain <= 0) return false;
  // Q12 matrix times Q11 responses over the Q11 gain: Q12, wanted Q8.
  dx_q8 = bounded_step((solve_xx_ * response.x + solve_xy_ * response.y) >> 4, response.gain);
  dy_q8 = bounded_step((solve_xy_ * response.x + solve_yy_ * response.y) >> 4, response.gain);
  return true;
}

std::uint32_t square_root(std::uint64_t value) {
  std::uint64_t root = 0;
  for (std::uint64_t bit = std::uint64_t{1} << 31; bit != 0; bit >>= 1) {
    const std::uint64_t trial = root | bit;
    if (trial * trial <= value) root = trial;
  }
  return static_cast<std::uint32_t>(root);
}

int Template::correlation_q10(const ImageView& image, int x_q8, int y_q8) const {
  std::int32_t sum = 0;
  std::int64_t squares = 0;
  std::int64_t product = 0;
  for_each_row(image, x_q8, y_q8, [&](int first, const std::int32_t* values) {
    std::int32_t row_squares = 0;
    std::int32_t row_product = 0;
    for (int i = 0; i < kSide; ++i) {
      const std::int32_t value = covered_[first + i] ? values[i] : 0;
      sum += value;
      row_squares += value * value;
      row_product += value_[first + i] * value;
    }
    squares += row_squares;
    product += row_product;
  });
  const std::int64_t variance = squares - static_cast<std::int64_t>(sum) * sum / count_;  // Q8
  if (variance <= 0) return 0;
  // The values have zero mean up to rounding; what is left of it meets the image's mean here.
  std::int32_t value_sum = 0;
  for (int i = 0; i < kPixels; ++i) value_sum += value_[i];
  product -= static_cast<std::int64_t>(value_sum) * sum / count_;
  const std::int64_t norm =
      static_cast<std::int64_t>(square_root(static_cast<std::uint64_t>(energy_))) *
      square_root(static_cast<std::uint64_t>(variance));  // Q11
  if (norm == 0) return 0;
  const std::int64_t correlation = product * 1024 / norm;
  return static_cast<int>(correlation > 1024 ? 1024 : correlation < -1024 ? -1024 : correlation);
}

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
  Template reference;
  if (!reference.build(patch, warp)) return Status::kDegenerate;
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
