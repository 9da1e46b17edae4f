#include "cairn/vision/warped_search.hpp"

#include "cairn/numeric/math.hpp"

namespace cairn {
namespace {

constexpr int kMaxSide = 2 * kMaxWarpedRadius + SmallTemplate::kSide;
constexpr int kOneQ8 = 256;

/// Pixels of a square of `side`, as another camera would see them that many of its pixels apart:
/// bilinear, at 1/256 pixel, beyond the border as at it. `first`: of the square's first column and
/// row, from (x_q8, y_q8). By value, so that the compiler keeps them in registers.
void resample(const ImageView image, const PatchWarp warp, int x_q8, int y_q8, int first, int step,
              int side, std::uint8_t* pixels) {
  const int last_x = (image.width - 1) * kOneQ8 - 1;
  const int last_y = (image.height - 1) * kOneQ8 - 1;
  for (int row = 0; row < side; ++row) {
    const int line = first + step * row;
    int dx = static_cast<int>(line * warp.xy + first * warp.xx);
    int dy = static_cast<int>(line * warp.yy + first * warp.yx);
    for (int column = 0; column < side; ++column) {
      const int x = clamp(x_q8 + (dx >> 8), 0, last_x);
      const int y = clamp(y_q8 + (dy >> 8), 0, last_y);
      const int u = x & (kOneQ8 - 1);
      const int v = y & (kOneQ8 - 1);
      const std::uint8_t* const top = image.row(y >> 8) + (x >> 8);
      const std::uint8_t* const bottom = top + image.stride;
      const int above = kOneQ8 * top[0] + u * (top[1] - top[0]);
      const int below = kOneQ8 * bottom[0] + u * (bottom[1] - bottom[0]);
      *pixels++ =
          static_cast<std::uint8_t>((kOneQ8 * above + v * (below - above) + (1 << 15)) >> 16);
      dx += static_cast<int>(step * warp.xx);
      dy += static_cast<int>(step * warp.yx);
    }
  }
}

/// Every second pixel of a template, with what normalises them.
struct Thinned {
  static constexpr int kSide = (SmallTemplate::kSide + 1) / 2;
  static constexpr int kPixels = kSide * kSide;
  std::int16_t values[kPixels] = {};
  std::int32_t sum = 0;

  explicit Thinned(const SmallTemplate& from) {
    for (int row = 0; row < kSide; ++row) {
      for (int column = 0; column < kSide; ++column) {
        const std::uint8_t v = from.pixels[2 * row * SmallTemplate::kSide + 2 * column];
        values[row * kSide + column] = v;
        sum += v;
      }
    }
  }
};

/// The place of a square of pixels of `side` where they correlate most. False where nothing
/// correlates.
bool best_place(const std::uint8_t* pixels, int side, const Thinned& reference, int& x, int& y) {
  const int places = side - Thinned::kSide + 1;
  float best = 0.0F;
  for (int row = 0; row < places; ++row) {
    for (int column = 0; column < places; ++column) {
      const std::uint8_t* p = pixels + row * side + column;
      const std::int16_t* v = reference.values;
      std::int32_t sum = 0;
      std::int32_t squares = 0;
      std::int32_t products = 0;
      const auto add = [&](int k) {
        const std::int32_t u = p[k];
        sum += u;
        squares += u * u;
        products += u * v[k];
      };
      for (int i = 0; i < Thinned::kSide; ++i, p += side, v += Thinned::kSide) {
        static_assert(Thinned::kSide == 6, "unrolled by hand");
        add(0);
        add(1);
        add(2);
        add(3);
        add(4);
        add(5);
      }
      const std::int32_t covariance = Thinned::kPixels * products - sum * reference.sum;
      const std::int32_t spread = Thinned::kPixels * squares - sum * sum;
      if (covariance <= 0 || spread <= 0) continue;
      const auto c = static_cast<float>(covariance);
      const float score = c * c / static_cast<float>(spread);
      if (!(score > best)) continue;
      best = score;
      x = column;
      y = row;
    }
  }
  return best > 0.0F;
}

/// Whether a search about this place can reach the image at all.
bool is_near(const ImageView& image, int x_q8, int y_q8) {
  constexpr int kReach = 4 * (kMaxSearchRadius + SmallTemplate::kSide) * kOneQ8;
  return x_q8 >= -kReach && y_q8 >= -kReach && x_q8 <= image.width * kOneQ8 + kReach &&
         y_q8 <= image.height * kOneQ8 + kReach;
}

bool is_moderate(const PatchWarp& warp) {
  constexpr std::int32_t kMost = 4 << 16;
  const auto good = [](std::int32_t v) { return v >= -kMost && v <= kMost; };
  return good(warp.xx) && good(warp.xy) && good(warp.yx) && good(warp.yy);
}

}  // namespace

Status find_warped_template(const ImageView& image, const SmallTemplate& reference,
                            const PatchWarp& warp, int x_q8, int y_q8, int radius, int least_q15,
                            TemplateMatch& match) {
  if (!is_moderate(warp) || image.width < 2 || image.height < 2) return Status::kNotFound;
  if (!is_near(image, x_q8, y_q8)) return Status::kNotFound;
  std::uint8_t pixels[kMaxSide * kMaxSide];
  const int side = 2 * radius + SmallTemplate::kSide;
  const int half = side / 2;
  resample(image, warp, x_q8, y_q8, -half, 1, side, pixels);
  TemplateMatch found;
  if (!ok(find_template({pixels, side, side, side}, reference, half, half, radius, least_q15,
                        found))) {
    return Status::kNotFound;
  }
  const std::int64_t u = found.x_q8 - half * kOneQ8;
  const std::int64_t v = found.y_q8 - half * kOneQ8;
  const auto x = static_cast<std::int32_t>(x_q8 + ((warp.xx * u + warp.xy * v) >> 16));
  const auto y = static_cast<std::int32_t>(y_q8 + ((warp.yx * u + warp.yy * v) >> 16));
  if (x < 0 || y < 0 || x > (image.width - 1) * kOneQ8 || y > (image.height - 1) * kOneQ8) {
    return Status::kNotFound;
  }
  match = {x, y, found.correlation};
  return Status::kOk;
}

Status find_warped_template_widely(const ImageView& image, const SmallTemplate& reference,
                                   const PatchWarp& warp, int x_q8, int y_q8, int radius,
                                   int least_q15, TemplateMatch& match) {
  constexpr int kMaxThinned = kMaxSearchRadius + Thinned::kSide;
  constexpr int kFineRadius = 2;
  if (!is_moderate(warp) || image.width < 2 || image.height < 2) return Status::kNotFound;
  if (!is_near(image, x_q8, y_q8)) return Status::kNotFound;
  radius += radius & 1;
  const int wide = radius + Thinned::kSide;
  if (wide <= Thinned::kSide || wide > kMaxThinned) return Status::kNotFound;
  int x = 0;
  int y = 0;
  {
    std::uint8_t pixels[kMaxThinned * kMaxThinned];
    resample(image, warp, x_q8, y_q8, -radius - SmallTemplate::kHalf, 2, wide, pixels);
    if (!best_place(pixels, wide, Thinned(reference), x, y)) return Status::kNotFound;
  }
  const int u = 2 * x - radius;
  const int v = 2 * y - radius;
  return find_warped_template(image, reference, warp, x_q8 + ((warp.xx * u + warp.xy * v) >> 8),
                              y_q8 + ((warp.yx * u + warp.yy * v) >> 8), kFineRadius, least_q15,
                              match);
}

}  // namespace cairn
