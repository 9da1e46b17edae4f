#include "cairn/mono/patch_search.hpp"

#include "cairn/numeric/math.hpp"
#include "cairn/numeric/packed_symmetric.hpp"

namespace cairn {
namespace {

constexpr int kHalf = 5;
constexpr int kSide = 2 * kHalf + 1;
constexpr int kPixels = kSide * kSide;
constexpr int kMargin = kHalf + 1;

/// The patch as the current view should show it.
struct Template {
  std::int32_t values[kPixels];
  std::int32_t sum;
  std::int64_t spread;  ///< kPixels^2 times the variance
};

/// Value of the patch at (x, y), Q16 from its centre, held at its border.
std::int32_t patch_value(const Patch& patch, std::int64_t x, std::int64_t y) {
  constexpr std::int64_t kCentre = Patch::kSize / 2;
  constexpr std::int64_t kLast = ((Patch::kSize - 1) << 16) - 1;
  const auto u = static_cast<std::int32_t>(clamp<std::int64_t>(x + (kCentre << 16), 0, kLast));
  const auto v = static_cast<std::int32_t>(clamp<std::int64_t>(y + (kCentre << 16), 0, kLast));
  const std::uint8_t* p = patch.pixels + (v >> 16) * Patch::kSize + (u >> 16);
  const std::int32_t fx = (u >> 8) & 255;
  const std::int32_t fy = (v >> 8) & 255;
  const std::int32_t top = p[0] * (256 - fx) + p[1] * fx;
  const std::int32_t bottom = p[Patch::kSize] * (256 - fx) + p[Patch::kSize + 1] * fx;
  return (top * (256 - fy) + bottom * fy + 32768) >> 16;
}

bool make_template(const Patch& patch, const PatchWarp& warp, Template& out) {
  const std::int64_t determinant = static_cast<std::int64_t>(warp.xx) * warp.yy -
                                   static_cast<std::int64_t>(warp.xy) * warp.yx;  // Q32
  if (determinant < (std::int64_t{1} << 29)) return false;
  const std::int64_t scale = determinant >> 16;
  const auto inverse = [scale](std::int32_t entry) {
    return (static_cast<std::int64_t>(entry) * 65536) / scale;
  };
  const std::int64_t xx = inverse(warp.yy), xy = inverse(-warp.xy);
  const std::int64_t yx = inverse(-warp.yx), yy = inverse(warp.xx);
  out.sum = 0;
  std::int64_t squares = 0;
  std::int32_t* value = out.values;
  for (int y = -kHalf; y <= kHalf; ++y) {
    for (int x = -kHalf; x <= kHalf; ++x) {
      *value = patch_value(patch, xx * x + xy * y, yx * x + yy * y);
      out.sum += *value;
      squares += *value * *value;
      ++value;
    }
  }
  out.spread = kPixels * squares - static_cast<std::int64_t>(out.sum) * out.sum;
  return out.spread >= 4 * kPixels * kPixels;
}

/// The squared correlation times the template's spread; 0 where it is not positive.
std::int64_t score_at(const ImageView& image, int x, int y, const Template& t) {
  std::int32_t sum = 0, squares = 0, product = 0;
  const std::int32_t* value = t.values;
  for (int j = -kHalf; j <= kHalf; ++j) {
    const std::uint8_t* row = image.data + (y + j) * image.stride + x - kHalf;
    for (int i = 0; i < kSide; ++i) {
      const std::int32_t v = row[i];
      sum += v;
      squares += v * v;
      product += v * *value++;
    }
  }
  const std::int64_t spread =
      static_cast<std::int64_t>(kPixels) * squares - static_cast<std::int64_t>(sum) * sum;
  const std::int64_t covariance =
      static_cast<std::int64_t>(kPixels) * product - static_cast<std::int64_t>(sum) * t.sum;
  if (spread <= 0 || covariance <= 0) return 0;
  return covariance * covariance / spread;
}

struct Best {
  int x = 0;
  int y = 0;
  std::int64_t score = 0;
};

}  // namespace

Status search_patch(const ImageView& image, const PixelPrediction<float>& prediction,
                    const Patch& patch, const PatchWarp& warp,
                    const PatchSearchParameters& parameters, Vector2<float>& pixel) {
  const Matrix2<float>& s = prediction.covariance;
  float i00, i01, i11;
  if (!invert_spd2(s(0, 0), s(0, 1), s(1, 1), i00, i01, i11)) return Status::kSingular;
  const auto inside = [&](float u, float v) {
    const float du = u - prediction.pixel.x();
    const float dv = v - prediction.pixel.y();
    return du * du * i00 + 2.0F * du * dv * i01 + dv * dv * i11 <= parameters.gate;
  };
  Template t;
  if (!make_template(patch, warp, t)) return Status::kDegenerate;

  constexpr int kLimit = PatchSearchParameters::kMaxHalfWindow;
  const int half_x = clamp(round_to_int(sqrt(parameters.gate * s(0, 0)) + 0.5F), 2, kLimit);
  const int half_y = clamp(round_to_int(sqrt(parameters.gate * s(1, 1)) + 0.5F), 2, kLimit);
  const int u = round_to_int(prediction.pixel.x());
  const int v = round_to_int(prediction.pixel.y());
  Best best;
  const auto consider = [&](int x, int y) {
    if (x < kMargin || y < kMargin || x >= image.width - kMargin || y >= image.height - kMargin) {
      return;
    }
    const std::int64_t score = score_at(image, x, y, t);
    if (score > best.score) best = {x, y, score};
  };
  for (int y = v - half_y; y <= v + half_y; y += 2) {
    for (int x = u - half_x; x <= u + half_x; x += 2) {
      if (inside(static_cast<float>(x), static_cast<float>(y))) consider(x, y);
    }
  }
  const Best coarse = best;
  if (coarse.score == 0) return Status::kNotFound;
  for (int y = coarse.y - 1; y <= coarse.y + 1; ++y) {
    for (int x = coarse.x - 1; x <= coarse.x + 1; ++x) consider(x, y);
  }
  const std::int64_t wanted =
      static_cast<std::int64_t>(parameters.min_correlation_q10) * parameters.min_correlation_q10;
  if ((best.score << 20) < wanted * t.spread) return Status::kNotFound;

  int x_q8 = best.x * 256;
  int y_q8 = best.y * 256;
  PatchAlignment alignment;
  if (!ok(align_patch(image, patch, warp, x_q8, y_q8, alignment))) return Status::kNotFound;
  const Vector2<float> found(static_cast<float>(x_q8) / 256.0F, static_cast<float>(y_q8) / 256.0F);
  if (!alignment.converged || alignment.correlation < parameters.min_aligned_q10 ||
      !inside(found.x(), found.y())) {
    return Status::kNotFound;
  }
  pixel = found;
  return Status::kOk;
}

}  // namespace cairn
