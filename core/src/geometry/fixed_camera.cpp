#include "cairn/geometry/fixed_camera.hpp"

#include "cairn/numeric/reciprocal.hpp"

namespace cairn {

Status FixedCamera::check_numbers() const {
  const bool good = fx.raw() > 0 && fy.raw() > 0 && width > 0 && height > 0;
  return good ? Status::kOk : Status::kBadConfig;
}

Status FixedMount::check() const {
  constexpr std::int64_t kOne = std::int64_t{1} << FixedRatio::kFractionBits;
  constexpr std::int64_t kOff = FixedRatio::nearest(1e-4).raw();
  std::int64_t sum = -kOne;
  for (const FixedRatio q : {w, x, y, z}) {
    sum += wide::round_shift(std::int64_t{q.raw()} * q.raw(), FixedRatio::kFractionBits);
  }
  return sum <= kOff && sum >= -kOff ? Status::kOk : Status::kInvalidArgument;
}

bool FixedCamera::contains(const FixedPixel (&pixel)[2], FixedPixel margin) const {
  constexpr int kBits = FixedPixel::kFractionBits;
  const auto inside = [margin](FixedPixel at, int size) {
    const std::int64_t most = std::int64_t{size - 1} * (std::int64_t{1} << kBits) - margin.raw();
    return at >= margin && at.raw() <= most;
  };
  return inside(pixel[0], width) && inside(pixel[1], height);
}

namespace detail {
namespace {

using Count = std::uint32_t;

struct Distortion {
  FixedTangent x;
  FixedTangent y;
  FixedTangent d00;
  FixedTangent d01;
  FixedTangent d11;
};

FixedTangent times(FixedTangent a, FixedTangent b, Count& count) {
  return multiply<FixedTangent>(a, b, count);
}
FixedTangent scaled(FixedTangent a, int factor, Count& count) {
  return FixedTangent::from_raw(wide::narrow(std::int64_t{a.raw()} * factor, count));
}

/// 1 + r2 (a k1 + r2 (b k2 + r2 c k3)).
FixedTangent radial(const FixedCamera& camera, FixedTangent r2, int a, int b, int c, Count& count) {
  FixedTangent sum = times(r2, scaled(camera.k3, c, count), count);
  sum = times(r2, add(scaled(camera.k2, b, count), sum, count), count);
  sum = times(r2, add(scaled(camera.k1, a, count), sum, count), count);
  return add(FixedTangent::nearest(1.0), sum, count);
}

bool folds_before(const FixedCamera& camera, FixedTangent r2, Count& count) {
  constexpr int kRadii = 16;
  for (int i = 1; i <= kRadii; ++i) {
    const auto at =
        FixedTangent::from_raw(static_cast<std::int32_t>((std::int64_t{r2.raw()} * i) / kRadii));
    if (radial(camera, at, 3, 5, 7, count).raw() <= 0) return true;
  }
  return false;
}

bool distort(const FixedCamera& camera, FixedTangent a, FixedTangent b, Distortion& out,
             Count& count) {
  constexpr FixedTangent kOne = FixedTangent::nearest(1.0);
  out = {a, b, kOne, {}, kOne};
  if (!camera.has_distortion()) return true;
  constexpr FixedTangent kWidest = FixedTangent::nearest(2.0);
  if (a > kWidest || b > kWidest || -a > kWidest || -b > kWidest) return false;
  const FixedTangent aa = times(a, a, count);
  const FixedTangent bb = times(b, b, count);
  constexpr std::int64_t kMost = std::int64_t{4} << FixedTangent::kFractionBits;
  if (std::int64_t{aa.raw()} + bb.raw() > kMost) return false;
  const FixedTangent ab = times(a, b, count);
  const FixedTangent r2 = add(aa, bb, count);
  if (folds_before(camera, r2, count)) return false;
  const FixedTangent factor = radial(camera, r2, 1, 1, 1, count);
  // d factor / d r2.
  FixedTangent slope = times(r2, scaled(camera.k3, 3, count), count);
  slope = times(r2, add(scaled(camera.k2, 2, count), slope, count), count);
  slope = add(camera.k1, slope, count);
  const auto sum = [&](FixedTangent x, FixedTangent y) { return add(x, y, count); };
  const FixedTangent p1a = times(camera.p1, a, count);
  const FixedTangent p1b = times(camera.p1, b, count);
  const FixedTangent p2a = times(camera.p2, a, count);
  const FixedTangent p2b = times(camera.p2, b, count);
  const auto lopsided = [&](FixedTangent p, FixedTangent own, FixedTangent across) {
    return sum(scaled(times(p, own, count), 3, count), times(p, across, count));
  };
  out.x = sum(times(a, factor, count), scaled(times(camera.p1, ab, count), 2, count));
  out.x = sum(out.x, lopsided(camera.p2, aa, bb));
  out.y = sum(times(b, factor, count), scaled(times(camera.p2, ab, count), 2, count));
  out.y = sum(out.y, lopsided(camera.p1, bb, aa));
  const auto slope_of = [&](FixedTangent squared, FixedTangent twice, FixedTangent sixfold) {
    const FixedTangent curved = sum(factor, scaled(times(squared, slope, count), 2, count));
    return sum(curved, sum(scaled(twice, 2, count), scaled(sixfold, 6, count)));
  };
  out.d00 = slope_of(aa, p1b, p2a);
  out.d11 = slope_of(bb, p2a, p1b);
  out.d01 = scaled(sum(times(ab, slope, count), sum(p1a, p2b)), 2, count);
  return true;
}

}  // namespace

/// False: too near, or more than 76 degrees from the axis.
bool is_ahead(const FixedLength (&p_camera)[3]) {
  constexpr FixedLength kLeastDepth = FixedLength::nearest(0.05);
  constexpr int kWidest = 4;
  const FixedLength z = p_camera[2];
  if (z < kLeastDepth) return false;
  const auto is_wide = [&](FixedLength at) {
    return wide::magnitude(at.raw()) > static_cast<std::uint64_t>(z.raw()) * kWidest;
  };
  return !is_wide(p_camera[0]) && !is_wide(p_camera[1]);
}

bool project_point(const FixedCamera& camera, const FixedLength (&p_camera)[3],
                   FixedPixel (&pixel)[2], Count& saturations) {
  if (camera.has_distortion()) {
    FixedProjection projection;
    if (!project(camera, p_camera, projection, saturations)) return false;
    for (int i = 0; i < 2; ++i) pixel[i] = projection.pixel[i];
    return true;
  }
  if (!is_ahead(p_camera)) return false;
  const Reciprocal inverse(p_camera[2].raw());
  const auto over = [&](FixedLength x) {
    const std::int64_t quotient = inverse.times(x.raw(), FixedTangent::kFractionBits);
    return FixedTangent::from_raw(wide::narrow(quotient, saturations));
  };
  pixel[0] =
      add(multiply<FixedPixel>(camera.fx, over(p_camera[0]), saturations), camera.cx, saturations);
  pixel[1] =
      add(multiply<FixedPixel>(camera.fy, over(p_camera[1]), saturations), camera.cy, saturations);
  return true;
}

bool project_ray(const FixedCamera& camera, FixedTangent a, FixedTangent b, FixedProjection& out,
                 Count& saturations) {
  Distortion d;
  if (!distort(camera, a, b, d, saturations)) return false;
  out.pixel[0] = add(multiply<FixedPixel>(camera.fx, d.x, saturations), camera.cx, saturations);
  out.pixel[1] = add(multiply<FixedPixel>(camera.fy, d.y, saturations), camera.cy, saturations);
  const FixedTangent rows[2][2] = {{d.d00, d.d01}, {d.d01, d.d11}};
  for (int i = 0; i < 2; ++i) {
    for (int j = 0; j < 2; ++j) out.rows[i][j] = rows[i][j];
    out.rows[i][2] =
        -add(times(rows[i][0], a, saturations), times(rows[i][1], b, saturations), saturations);
  }
  return true;
}

bool unproject(const FixedCamera& camera, const FixedPixel (&pixel)[2], FixedTangent (&ray)[2]) {
  constexpr int kSteps = 12;
  constexpr std::int32_t kClose = FixedPixel::nearest(0.01).raw();
  constexpr int kBits = FixedTangent::kFractionBits;
  Count lost = 0;
  const FixedPixel centre[2] = {camera.cx, camera.cy};
  const FixedPixel focal[2] = {camera.fx, camera.fy};
  for (int i = 0; i < 2; ++i) {
    ray[i] = divide<FixedTangent>(subtract(pixel[i], centre[i], lost), focal[i], lost);
  }
  if (!camera.has_distortion()) return lost == 0;
  for (int step = 0; step < kSteps && lost == 0; ++step) {
    FixedProjection seen;
    if (!project_ray(camera, ray[0], ray[1], seen, lost)) return false;
    std::int64_t off[2];  // in tangents
    bool close = true;
    for (int i = 0; i < 2; ++i) {
      const FixedPixel by = subtract(pixel[i], seen.pixel[i], lost);
      close = close && by.raw() <= kClose && by.raw() >= -kClose;
      off[i] = divide<FixedTangent>(by, focal[i], lost).raw();
    }
    if (close) return lost == 0;
    const auto entry = [&](int i, int j) { return std::int64_t{seen.rows[i][j].raw()}; };
    const auto product = [&](std::int64_t x, std::int64_t y) {
      return wide::multiply(x, y, kBits, lost);
    };
    const std::int64_t determinant =
        product(entry(0, 0), entry(1, 1)) - product(entry(0, 1), entry(1, 0));
    const std::int64_t by[2] = {product(entry(1, 1), off[0]) - product(entry(0, 1), off[1]),
                                product(entry(0, 0), off[1]) - product(entry(1, 0), off[0])};
    if (determinant <= 0) return false;
    for (int i = 0; i < 2; ++i) {
      const std::int64_t moved = ray[i].raw() + wide::divide(by[i], determinant, kBits, lost);
      ray[i] = FixedTangent::from_raw(wide::narrow(moved, lost));
    }
  }
  return false;
}

bool project(const FixedCamera& camera, const FixedLength (&p_camera)[3], FixedProjection& out,
             Count& saturations) {
  if (!is_ahead(p_camera)) return false;
  const Reciprocal inverse(p_camera[2].raw());
  const auto over = [&](FixedLength x) {
    const std::int64_t quotient = inverse.times(x.raw(), FixedTangent::kFractionBits);
    return FixedTangent::from_raw(wide::narrow(quotient, saturations));
  };
  return project_ray(camera, over(p_camera[0]), over(p_camera[1]), out, saturations);
}

}  // namespace detail
}  // namespace cairn
