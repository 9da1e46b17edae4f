#pragma once

#include "cairn/tracking/fixed_seed_odometry.hpp"

namespace cairn {

template <int MaxSeeds, int MaxKeyframes>
Rigid<float> FixedSeedOdometry<MaxSeeds, MaxKeyframes>::T_camera_first(const Seed& seed) const {
  const FixedRigid& first = keyframes_[seed.keyframe].T_pool_camera;
  const detail::FixedMotionBetween motion = detail::motion_between(T_pool_camera_, first, lost_);
  std::uint32_t none = 0;
  FixedRigid out = back().times(first, none);
  for (int i = 0; i < 3; ++i) out.translation[i] = convert<FixedCoordinate>(motion.t[i], none);
  return float_of(out);
}

template <int MaxSeeds, int MaxKeyframes>
bool FixedSeedOdometry<MaxSeeds, MaxKeyframes>::turn_since(LandmarkId keyframe,
                                                           Quaternion<float>& now_then,
                                                           float& yaw_variance) const {
  const int slot = find_keyframe(keyframe);
  if (slot < 0) return false;
  std::uint32_t none = 0;
  now_then = float_of(back().times(keyframes_[slot].T_pool_camera, none)).rotation;
  yaw_variance = float_of(filter_.yaw_variance(slot));
  return true;
}

template <int MaxSeeds, int MaxKeyframes>
void FixedSeedOdometry<MaxSeeds, MaxKeyframes>::move_to(const FixedRigid& T_odometry_camera,
                                                        const SeedParameters& parameters) {
  if (has_pose_) {
    FixedRigid step;
    FixedRigid inverse = T_odometry_last_;
    for (int i = 1; i < 4; ++i) inverse.rotation[i] = -inverse.rotation[i];
    for (FixedCoordinate& t : inverse.translation) t = {};
    FixedRigid moved = T_odometry_camera;
    for (int i = 0; i < 3; ++i) {
      moved.translation[i] = subtract(moved.translation[i], T_odometry_last_.translation[i], lost_);
    }
    step = inverse.times(moved, lost_);
    T_pool_camera_ = T_pool_camera_.times(step, lost_);
    filter_.predict(fixed_of<FixedAngle>(parameters.sigma_pitch_rad, lost_),
                    fixed_of<FixedAngle>(parameters.sigma_yaw_rad, lost_));
  }
  T_odometry_last_ = T_odometry_camera;
  has_pose_ = true;
}

template <int MaxSeeds, int MaxKeyframes>
bool FixedSeedOdometry<MaxSeeds, MaxKeyframes>::look(const PinholeCamera<float>& camera,
                                                     const SeedParameters& parameters,
                                                     View& view) const {
  if (!ok(fixed_of(camera, view.camera))) return false;
  const auto sigma = fixed_of<FixedPixel>(parameters.sigma_px, lost_);
  view.sigma[0] = divide<FixedTangent>(sigma, view.camera.fx, lost_);
  view.sigma[1] = divide<FixedTangent>(sigma, view.camera.fy, lost_);
  view.off_path = fixed_of<FixedTangent>(parameters.off_path, lost_);
  view.sigma_roll = fixed_of<FixedAngle>(parameters.sigma_roll_rad, lost_);
  view.gate = fixed_of<Fixed<std::int32_t, 16>>(parameters.gate, lost_);
  for (int k = 0; k < MaxKeyframes; ++k) {
    if (keyframes_[k].id == kNoLandmark) continue;
    view.T_camera_first[k] =
        detail::motion_between(T_pool_camera_, keyframes_[k].T_pool_camera, lost_);
  }
  return true;
}

/// Distances are multiples of the depth at the keyframe: the point is R ray + rho t.
template <int MaxSeeds, int MaxKeyframes>
bool FixedSeedOdometry<MaxSeeds, MaxKeyframes>::expect(const View& view, const Seeds& seeds, int i,
                                                       Expected& expected) const {
  constexpr int kPointBits = FixedOffset::kFractionBits;
  constexpr std::int32_t kNearest = FixedOffset::nearest(0.05).raw();
  constexpr FixedPixel kOutside = FixedPixel::nearest(-40.0);
  const auto squared = [](std::int32_t raw) {
    return static_cast<std::uint64_t>(std::int64_t{raw} * raw);
  };
  const Seed& seed = seeds[i];
  const detail::FixedMotionBetween& T = view.T_camera_first[seed.keyframe];
  const std::int32_t rho = rho_of(seed, lost_).raw();
  const std::int32_t ray[2] = {fixed_of<FixedTangent>(seed.first_ray.x(), lost_).raw(),
                               fixed_of<FixedTangent>(seed.first_ray.y(), lost_).raw()};
  std::int32_t point[3];
  std::uint64_t way_squared = 0;
  for (int k = 0; k < 3; ++k) {
    // R has two bits more than a tangent.
    const std::int64_t turned = (std::int64_t{T.R.r[k][0].raw()} * ray[0] >> 2) +
                                (std::int64_t{T.R.r[k][1].raw()} * ray[1] >> 2) +
                                std::int64_t{T.R.r[k][2].raw()} * (1 << 26);
    const std::int64_t moved =
        wide::round_shift(std::int64_t{T.t[k].raw()} * rho, Rho::kFractionBits);
    point[k] = wide::narrow(
        wide::round_shift(turned, 2 * FixedTangent::kFractionBits - kPointBits) + moved, lost_);
    way_squared += squared(wide::narrow(moved, lost_));
  }
  if (point[2] < kNearest) return false;
  const Reciprocal over_depth(point[2]);
  const auto tangent = [&](std::int32_t of) {
    std::uint32_t wide_angle = 0;
    return FixedTangent::from_raw(
        wide::narrow(over_depth.times(of, FixedTangent::kFractionBits), wide_angle));
  };
  const FixedTangent a = tangent(point[0]);
  const FixedTangent b = tangent(point[1]);
  constexpr FixedTangent kWidest = FixedTangent::nearest(4.0);
  if (a > kWidest || b > kWidest || -a > kWidest || -b > kWidest) return false;
  detail::FixedProjection& projection = expected.seen.projection;
  if (!detail::project_ray(view.camera, a, b, projection, lost_)) return false;
  const std::int64_t off =
      wide::round_shift(std::int64_t{integer_sqrt(way_squared)} * view.off_path.raw(), kPointBits);
  const std::uint64_t off_squared = squared(wide::narrow(off, lost_));
  for (int r = 0; r < 2; ++r) {
    expected.pixel[r] = projection.pixel[r];
    const std::uint32_t sigma = integer_sqrt(squared(view.sigma[r].raw()) + off_squared);
    expected.sigma[r] = FixedTangent::from_raw(wide::narrow(sigma, lost_));
  }
  expected.seen.depth = point[2];

  typename Filter::Residual& residual = expected.residual;
  residual.slot = i;
  residual.keyframe = seed.keyframe;
  const auto times = [&](std::int32_t x, std::int32_t y) {
    return wide::round_shift(std::int64_t{x} * y, FixedTangent::kFractionBits);
  };
  const auto narrow = [&](std::int64_t raw) {
    return FixedTangent::from_raw(wide::narrow(raw, lost_));
  };
  for (int r = 0; r < 2; ++r) {
    const std::int32_t g[3] = {projection.rows[r][0].raw(), projection.rows[r][1].raw(),
                               projection.rows[r][2].raw()};
    // g x (a, b, 1), of which the third part is the roll's.
    residual.by_camera[r][0] = narrow(g[1] - times(g[2], b.raw()));
    residual.by_camera[r][1] = narrow(times(g[2], a.raw()) - g[0]);
    const std::int64_t by_roll = times(g[0], b.raw()) - times(g[1], a.raw());
    residual.unmodelled[r] =
        narrow(wide::multiply(by_roll, view.sigma_roll.raw(), FixedAngle::kFractionBits, lost_));
    std::int32_t u[3];
    std::int64_t along = 0;
    for (int k = 0; k < 3; ++k) {
      std::int64_t sum = 0;
      for (int j = 0; j < 3; ++j) sum += std::int64_t{g[j]} * T.R.r[j][k].raw() >> 2;
      u[k] = wide::narrow(wide::round_shift(sum, FixedRatio::kFractionBits - 2), lost_);
      along += std::int64_t{g[k]} * T.t[k].raw() >> 2;
    }
    const auto over = [&](std::int64_t value, int fraction) {
      return wide::narrow(over_depth.times(wide::narrow(value, lost_), fraction), lost_);
    };
    residual.by_keyframe[r][0] =
        FixedTangent::from_raw(over(times(u[2], ray[1]) - u[1], kPointBits));
    residual.by_keyframe[r][1] =
        FixedTangent::from_raw(over(u[0] - times(u[2], ray[0]), kPointBits));
    residual.by_depth[r] = FixedLength::from_raw(over(
        wide::round_shift(along, FixedTangent::kFractionBits - 2), FixedLength::kFractionBits));
  }
  return view.camera.contains(expected.pixel, kOutside);
}

template <int MaxSeeds, int MaxKeyframes>
bool FixedSeedOdometry<MaxSeeds, MaxKeyframes>::plan(const View& view,
                                                     const SeedParameters& parameters,
                                                     const Seeds& seeds, int i,
                                                     Search& search) const {
  Expected expected;
  if (!expect(view, seeds, i, expected)) return false;
  const Seed& seed = seeds[i];
  FixedView first;
  first.depth = 1 << FixedOffset::kFractionBits;
  if (!detail::project_ray(view.camera, fixed_of<FixedTangent>(seed.first_ray.x(), lost_),
                           fixed_of<FixedTangent>(seed.first_ray.y(), lost_), first.projection,
                           lost_) ||
      !predict_patch_warp(view.camera, first, expected.seen, view.T_camera_first[seed.keyframe].R,
                          search.warp)) {
    return false;
  }
  const typename Filter::Innovation s =
      filter_.innovation_covariance(expected.residual, expected.sigma);
  const std::int32_t f[2] = {view.camera.fx.raw(), view.camera.fy.raw()};
  const auto pixels_squared = [&](std::int64_t value, int r, int c) {
    // From the rows' scales, times the focal lengths.
    const int shift = s.bits[r] + s.bits[c] - 32 + 2 * FixedPixel::kFractionBits -
                      FixedPixelVariance::kFractionBits;
    std::uint32_t none = 0;
    const std::int64_t product =
        wide::multiply(value, std::int64_t{f[r]} * f[c], clamp(shift, 0, 126), none);
    return FixedPixelVariance::from_raw(shift < 0 ? wide::scale(product, -shift, none) : product);
  };
  FixedPixelPrediction prediction;
  for (int r = 0; r < 2; ++r) prediction.pixel[r] = expected.pixel[r];
  prediction.xx = pixels_squared(s.xx, 0, 0);
  prediction.xy = pixels_squared(s.xy, 0, 1);
  prediction.yy = pixels_squared(s.yy, 1, 1);
  return search.window.set(prediction, parameters.search);
}

template <int MaxSeeds, int MaxKeyframes>
void FixedSeedOdometry<MaxSeeds, MaxKeyframes>::off(const Expected& expected,
                                                    const Vector2<float>& pixel,
                                                    FixedPixel (&off)[2], std::uint32_t& lost) {
  for (int r = 0; r < 2; ++r) {
    off[r] = subtract(fixed_of<FixedPixel>(pixel(r), lost), expected.pixel[r], lost);
  }
}

template <int MaxSeeds, int MaxKeyframes>
void FixedSeedOdometry<MaxSeeds, MaxKeyframes>::correct(const View& view,
                                                        const SeedParameters& parameters,
                                                        Seeds& seeds, const Vector2<float>* pixels,
                                                        bool* found) {
  FixedPixel median[2];
  if (!off_median(view, seeds, pixels, found, median)) return;
  typename Filter::Correction correction;
  for (int i = 0; i < seeds.size(); ++i) {
    Expected expected;
    if (!found[i]) continue;
    found[i] = expect(view, seeds, i, expected);
    if (!found[i]) continue;
    FixedPixel away[2];
    off(expected, pixels[i], away, lost_);
    for (int r = 0; r < 2; ++r) {
      const FixedPixel f = r == 0 ? view.camera.fx : view.camera.fy;
      expected.residual.pixel[r] = divide<FixedTangent>(away[r], f, lost_);
    }
    found[i] = near_median(view, expected, away, median) &&
               filter_.update(expected.residual, expected.sigma, view.gate, correction);
  }
  apply(correction, parameters, seeds);
}

/// As SeedOdometry's: (off^2 - across) (across + d^2) <= (off d)^2, d the seed's way along its
/// epipolar line by three deviations of its depth.
template <int MaxSeeds, int MaxKeyframes>
bool FixedSeedOdometry<MaxSeeds, MaxKeyframes>::near_median(const View& view,
                                                            const Expected& expected,
                                                            const FixedPixel (&off)[2],
                                                            const FixedPixel (&median)[2]) const {
  constexpr int kBits = 4;
  constexpr std::int64_t kAcross = 9 << (2 * kBits);
  constexpr int kSquaredSigmas = 9;
  constexpr std::int64_t kMost = std::int64_t{1} << 14;  // px, kBits: no window is as large
  const auto limited = [](std::int64_t v) { return v > kMost ? kMost : v < -kMost ? -kMost : v; };
  std::int64_t across = kAcross;
  std::int64_t off_off = 0;
  std::int64_t d_d = 0;
  std::int64_t off_d = 0;
  const std::int64_t sigma = 3 * filter_.sigma(expected.residual.slot).raw();
  for (int r = 0; r < 2; ++r) {
    const std::int64_t f = r == 0 ? view.camera.fx.raw() : view.camera.fy.raw();
    constexpr int kShift = FixedPixel::kFractionBits - kBits;
    const std::int64_t roll = wide::multiply(expected.residual.unmodelled[r].raw(), f,
                                             FixedTangent::kFractionBits + kShift, lost_);
    across += kSquaredSigmas * limited(roll) * limited(roll);
    const std::int64_t away =
        limited(wide::round_shift(std::int64_t{off[r].raw()} - median[r].raw(), kShift));
    const std::int64_t slope =
        wide::multiply(expected.residual.by_depth[r].raw(), f, FixedLength::kFractionBits, lost_);
    const std::int64_t d =
        limited(wide::multiply(slope, sigma, Filter::Rho::kFractionBits + kShift, lost_));
    off_off += away * away;
    d_d += d * d;
    off_d += away * d;
  }
  return (off_off - across) * (across + d_d) <= off_d * off_d;
}

template <int MaxSeeds, int MaxKeyframes>
void FixedSeedOdometry<MaxSeeds, MaxKeyframes>::apply(const typename Filter::Correction& correction,
                                                      const SeedParameters& parameters,
                                                      Seeds& seeds) {
  turn(T_pool_camera_, correction.camera(0), correction.camera(1));
  for (int k = 0; k < MaxKeyframes; ++k) {
    if (keyframes_[k].id == kNoLandmark) continue;
    turn(keyframes_[k].T_pool_camera, correction.keyframe(k, 0), correction.keyframe(k, 1));
  }
  constexpr auto kShare = Fixed<std::int32_t, 20>::nearest(0.2);
  const auto least = divide<typename Filter::Rho>(
      kShare, fixed_of<FixedLength>(parameters.max_depth_m, lost_), lost_);
  for (int i = 0; i < seeds.size(); ++i) {
    Seed& seed = seeds[i];
    auto rho = fixed_of<typename Filter::Rho>(seed.rho, lost_);
    rho = add(rho, correction.depth(i), lost_);
    seed.rho = float_of(rho < least ? least : rho);
  }
}

template <int MaxSeeds, int MaxKeyframes>
bool FixedSeedOdometry<MaxSeeds, MaxKeyframes>::off_median(const View& view, const Seeds& seeds,
                                                           const Vector2<float>* pixels,
                                                           const bool* found,
                                                           FixedPixel (&median)[2]) const {
  FixedPixel u[MaxSeeds];
  FixedPixel v[MaxSeeds];
  int count = 0;
  for (int i = 0; i < seeds.size(); ++i) {
    Expected expected;
    if (!found[i] || !expect(view, seeds, i, expected)) continue;
    FixedPixel away[2];
    off(expected, pixels[i], away, lost_);
    insert_sorted(u, count, away[0]);
    insert_sorted(v, count, away[1]);
    ++count;
  }
  if (count == 0) return false;
  median[0] = u[count / 2];
  median[1] = v[count / 2];
  return true;
}

}  // namespace cairn
