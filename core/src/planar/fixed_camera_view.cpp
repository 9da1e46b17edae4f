#include "cairn/planar/fixed/camera.hpp"

namespace cairn::detail {
namespace {

using Count = std::uint32_t;

}  // namespace

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

}  // namespace cairn::detail
