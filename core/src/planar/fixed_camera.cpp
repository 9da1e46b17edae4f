#include "cairn/planar/fixed/camera.hpp"

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

/// Sum of three products with 30 fraction bits, in the format of the second factors.
std::int64_t sum_of(const FixedRatio (&a)[3], std::int64_t x, std::int64_t y, std::int64_t z) {
  return wide::round_shift(a[0].raw() * x + a[1].raw() * y + a[2].raw() * z,
                           FixedRatio::kFractionBits);
}

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
  const bool none = camera.k1.raw() == 0 && camera.k2.raw() == 0 && camera.k3.raw() == 0 &&
                    camera.p1.raw() == 0 && camera.p2.raw() == 0;
  if (none) return true;
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

FixedRotation FixedRotation::operator*(const FixedRotation& other) const {
  FixedRotation out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const std::int64_t sum =
          sum_of(r[i], other.r[0][j].raw(), other.r[1][j].raw(), other.r[2][j].raw());
      out.r[i][j] = FixedRatio::from_raw(static_cast<std::int32_t>(sum));
    }
  }
  return out;
}

FixedRotation FixedRotation::transposed() const {
  FixedRotation out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out.r[i][j] = r[j][i];
  }
  return out;
}

void FixedRotation::turn(const FixedLength (&v)[3], FixedLength (&out)[3],
                         Count& saturations) const {
  for (int i = 0; i < 3; ++i) {
    out[i] = FixedLength::from_raw(
        wide::narrow(sum_of(r[i], v[0].raw(), v[1].raw(), v[2].raw()), saturations));
  }
}

FixedRotation rotation_of(const FixedMount& mount) {
  Count none = 0;
  const auto product = [&](FixedRatio a, FixedRatio b) {
    return std::int64_t{multiply<FixedRatio>(a, b, none).raw()};
  };
  constexpr std::int64_t kOne = std::int64_t{1} << FixedRatio::kFractionBits;
  const FixedRatio w = mount.w;
  const FixedRatio x = mount.x;
  const FixedRatio y = mount.y;
  const FixedRatio z = mount.z;
  const auto entry = [&](std::int64_t value) {
    return FixedRatio::from_raw(wide::narrow(value, none));
  };
  const auto diagonal = [&](FixedRatio a, FixedRatio b) {
    return entry(kOne - 2 * (product(a, a) + product(b, b)));
  };
  const auto other = [&](FixedRatio a, FixedRatio b, FixedRatio c, int sign) {
    return entry(2 * (product(a, b) + sign * product(w, c)));
  };
  FixedRotation out;
  out.r[0][0] = diagonal(y, z);
  out.r[0][1] = other(x, y, z, -1);
  out.r[0][2] = other(x, z, y, 1);
  out.r[1][0] = other(x, y, z, 1);
  out.r[1][1] = diagonal(x, z);
  out.r[1][2] = other(y, z, x, -1);
  out.r[2][0] = other(x, z, y, -1);
  out.r[2][1] = other(y, z, x, 1);
  out.r[2][2] = diagonal(x, y);
  return out;
}

FixedRotation rotation_of(const FixedTilt& tilt) {
  FixedRotation pitch;
  FixedRotation roll;
  FixedRatio sine;
  FixedRatio cosine;
  sin_cos(tilt.pitch, sine, cosine);
  pitch.r[0][0] = cosine;
  pitch.r[0][2] = sine;
  pitch.r[2][0] = -sine;
  pitch.r[2][2] = cosine;
  sin_cos(tilt.roll, sine, cosine);
  roll.r[1][1] = cosine;
  roll.r[1][2] = -sine;
  roll.r[2][1] = sine;
  roll.r[2][2] = cosine;
  return pitch * roll;
}

FixedRotation rotation_about_vertical(FixedRatio cosine, FixedRatio sine) {
  FixedRotation out;
  out.r[0][0] = cosine;
  out.r[0][1] = -sine;
  out.r[1][0] = sine;
  out.r[1][1] = cosine;
  return out;
}

bool project(const FixedCamera& camera, const FixedLength (&p_camera)[3], FixedProjection& out,
             Count& saturations) {
  constexpr FixedLength kLeastDepth = FixedLength::nearest(0.05);
  constexpr int kWidest = 4;
  const FixedLength z = p_camera[2];
  if (z < kLeastDepth) return false;
  const auto is_wide = [&](FixedLength at) {
    return wide::magnitude(at.raw()) > static_cast<std::uint64_t>(z.raw()) * kWidest;
  };
  if (is_wide(p_camera[0]) || is_wide(p_camera[1])) return false;
  Count none = 0;
  const auto a = divide<FixedTangent>(p_camera[0], z, none);
  const auto b = divide<FixedTangent>(p_camera[1], z, none);
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

FixedCameraView::FixedCameraView(const FixedCamera& pinhole, const FixedMount& mount,
                                 FixedRatio cosine, FixedRatio sine, const FixedTilt* tilt,
                                 Count& saturations)
    : camera(&pinhole), tilts(tilt != nullptr) {
  const FixedRotation mounted = rotation_of(mount).transposed();
  mounted.turn(mount.origin, t_camera, saturations);
  for (FixedLength& t : t_camera) t = -t;
  const FixedRotation R_world_level = rotation_about_vertical(cosine, sine);
  if (tilt == nullptr) {
    R_camera_world = mounted * R_world_level.transposed();
    return;
  }
  R_camera_world = mounted * (R_world_level * rotation_of(*tilt)).transposed();
  // Pitch about the level y axis, roll about the body's x axis.
  FixedRatio sine_pitch;
  FixedRatio cosine_pitch;
  sin_cos(tilt->pitch, sine_pitch, cosine_pitch);
  Count none = 0;
  axes[0][0] = -sine;
  axes[0][1] = cosine;
  axes[1][0] = multiply<FixedRatio>(cosine, cosine_pitch, none);
  axes[1][1] = multiply<FixedRatio>(sine, cosine_pitch, none);
  axes[1][2] = -sine_pitch;
}

void FixedCameraView::to_camera(const FixedLength (&relative)[3], FixedLength (&p)[3],
                                Count& saturations) const {
  R_camera_world.turn(relative, p, saturations);
  for (int i = 0; i < 3; ++i) p[i] = add(p[i], t_camera[i], saturations);
}

bool FixedCameraView::see(const FixedLength (&relative)[3], FixedProjection& out,
                          Count& saturations) const {
  FixedLength p[3];
  to_camera(relative, p, saturations);
  return project(*camera, p, out, saturations);
}

bool FixedCameraView::linearise(const FixedLength (&relative)[3], FixedPixelRows& out,
                                Count& saturations) const {
  constexpr FixedLength kNearest = FixedLength::nearest(0.3);
  FixedLength(&p)[3] = out.p_camera;
  to_camera(relative, p, saturations);
  if (p[2] < kNearest) return false;
  FixedProjection projection;
  if (!project(*camera, p, projection, saturations)) return false;
  for (int r = 0; r < 2; ++r) {
    out.pixel[r] = projection.pixel[r];
    const FixedPixel f = r == 0 ? camera->fx : camera->fy;
    out.per_pixel[r] = wide::divide(
        p[2].raw(), f.raw(), kPixelBits - FixedLength::kFractionBits + FixedPixel::kFractionBits,
        saturations);
    for (int k = 0; k < 3; ++k) {
      std::int64_t sum = 0;
      for (int i = 0; i < 3; ++i) {
        sum += std::int64_t{projection.rows[r][i].raw()} * R_camera_world.r[i][k].raw();
      }
      out.h[r][k] = FixedTangent::from_raw(
          wide::narrow(wide::round_shift(sum, FixedRatio::kFractionBits), saturations));
    }
  }
  for (int k = 0; k < 3; ++k)
    out.depth[k] = convert<FixedTangent>(R_camera_world.r[2][k], saturations);
  for (int k = 0; k < 2; ++k) {
    FixedLength turned[3] = {};
    if (tilts) {
      for (int i = 0; i < 3; ++i) {
        const int next = (i + 1) % 3;
        const int last = (i + 2) % 3;
        turned[i] = subtract(multiply<FixedLength>(relative[next], axes[k][last], saturations),
                             multiply<FixedLength>(relative[last], axes[k][next], saturations),
                             saturations);
      }
    }
    for (int r = 0; r < 2; ++r) {
      FixedLength sum;
      for (int i = 0; i < 3; ++i) {
        sum = add(sum, multiply<FixedLength>(turned[i], out.h[r][i], saturations), saturations);
      }
      out.tilt[r][k] = sum;
    }
  }
  return true;
}

}  // namespace detail
}  // namespace cairn
