#include "cairn/map/fixed_visibility.hpp"

#include "cairn/numeric/float_bits.hpp"

namespace cairn {
namespace {

using Count = std::uint32_t;

/// Sum of products, less two bits.
std::int64_t dot(const FixedOffset (&a)[3], const FixedOffset (&b)[3]) {
  std::int64_t sum = 0;
  for (int i = 0; i < 3; ++i) sum += std::int64_t{a[i].raw()} * b[i].raw() >> 2;
  return sum;
}

/// Cosine of the angle between two vectors; 0 where one has no length.
FixedRatio cosine_between(const FixedOffset (&a)[3], const FixedOffset (&b)[3]) {
  const FixedRoot first = square_root(dot(a, a), 0);
  const FixedRoot second = square_root(dot(b, b), 0);
  Count lost = 0;
  const std::int64_t lengths = std::int64_t{first.mantissa} * second.mantissa;
  const int shift = FixedRatio::kFractionBits + first.bits + second.bits;
  if (lengths == 0 || shift < 0 || shift > 126) return {};
  return FixedRatio::from_raw(wide::narrow(wide::divide(dot(a, b), lengths, shift, lost), lost));
}

}  // namespace

FixedLandmarkViews::FixedLandmarkViews(const PinholeCamera<float>& camera,
                                       const Rigid<float>& T_map_camera,
                                       const VisibilityOptions<float>& options) {
  Count lost = 0;
  usable_ = ok(fixed_of(camera, camera_));
  T_map_camera_ = fixed_rigid_of(T_map_camera, lost);
  R_camera_map_ = detail::rotation_of(T_map_camera_).transposed();
  focal_ = FixedPixel::from_raw(camera_.fx.raw() / 2 + camera_.fy.raw() / 2);
  margin_ = fixed_of<FixedPixel>(options.margin_px, lost);
  min_scale_ = fixed_of<Scale>(options.min_scale, lost);
  max_scale_ = fixed_of<Scale>(options.max_scale, lost);
  min_cosine_ = fixed_of<FixedRatio>(options.min_cosine, lost);
  usable_ = usable_ && lost == 0;
}

bool FixedLandmarkViews::look_at(const Vector3<float>& p_map, Point& point) const {
  Count lost = 0;
  FixedLength away[3];
  for (int i = 0; i < 3; ++i) {
    point.p_map[i] = fixed_of<FixedCoordinate>(p_map(i), lost);
    const FixedCoordinate to_camera = subtract(T_map_camera_.translation[i], point.p_map[i], lost);
    point.to_camera[i] = convert<FixedOffset>(to_camera, lost);
    away[i] = convert<FixedLength>(-to_camera, lost);
  }
  FixedLength p_camera[3];
  R_camera_map_.turn(away, p_camera, lost);
  FixedPixel pixel[2];
  if (!usable_ || lost != 0 || !detail::project_point(camera_, p_camera, pixel, lost) ||
      lost != 0 || !camera_.contains(pixel, margin_)) {
    return false;
  }
  point.depth = p_camera[2];
  return true;
}

bool FixedLandmarkViews::is_like(const Point& point, const LandmarkView<float>& view,
                                 FixedRatio& best_cosine) const {
  constexpr FixedLength kLeastDepth = FixedLength::nearest(0.05);
  Count lost = 0;
  const FixedRigid reference = fixed_rigid_of(view.T_map_reference, lost);
  const detail::FixedRotation R = detail::rotation_of(reference);
  FixedOffset to_reference[3];
  std::int64_t depth = 0;
  for (int i = 0; i < 3; ++i) {
    const FixedCoordinate way = subtract(reference.translation[i], point.p_map[i], lost);
    to_reference[i] = convert<FixedOffset>(way, lost);
    depth -= wide::multiply(R.r[i][2].raw(), way.raw(), FixedRatio::kFractionBits, lost);
  }
  const auto depth_then = convert<FixedLength>(FixedCoordinate::from_raw(depth), lost);
  if (lost != 0 || depth_then < kLeastDepth) return false;
  // (f z_ref) / (f_ref z).
  const auto focal_then = fixed_of<FixedPixel>(view.focal_px, lost);
  const std::int64_t now = std::int64_t{focal_then.raw()} * point.depth.raw();
  const std::int64_t then = std::int64_t{focal_.raw()} * depth_then.raw();
  if (lost != 0 || now <= 0) return false;
  const std::int64_t scale = wide::divide(then, now, Scale::kFractionBits, lost);
  if (lost != 0 || scale < min_scale_.raw() || scale > max_scale_.raw()) return false;
  const FixedRatio cosine = cosine_between(point.to_camera, to_reference);
  if (cosine < best_cosine) return false;
  best_cosine = cosine;
  return true;
}

}  // namespace cairn
