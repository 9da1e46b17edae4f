#include "cairn/tracking/fixed_seed_motion.hpp"

namespace cairn {

FixedStayingInView::FixedStayingInView(const PinholeCamera<float>& camera,
                                       const Rigid<float>& T_later_now, float depth_m) {
  std::uint32_t lost = 0;
  const FixedRigid pose = fixed_rigid_of(T_later_now, lost);
  T_later_now_.R = detail::rotation_of(pose);
  for (int i = 0; i < 3; ++i) {
    T_later_now_.t[i] = convert<FixedOffset>(pose.translation[i], lost);
  }
  depth_ = fixed_of<FixedLength>(depth_m, lost);
  usable_ = ok(fixed_of(camera, camera_)) && lost == 0;
}

bool FixedStayingInView::operator()(const Vector2<float>& pixel) const {
  constexpr FixedPixel kMargin = FixedPixel::nearest(static_cast<double>(kStayingMargin_px));
  std::uint32_t lost = 0;
  const FixedPixel at[2] = {fixed_of<FixedPixel>(pixel.x(), lost),
                            fixed_of<FixedPixel>(pixel.y(), lost)};
  FixedTangent ray[2];
  if (!usable_ || !detail::unproject(camera_, at, ray)) return false;
  const FixedLength p_now[3] = {multiply<FixedLength>(ray[0], depth_, lost),
                                multiply<FixedLength>(ray[1], depth_, lost), depth_};
  FixedLength p_later[3];
  T_later_now_.R.turn(p_now, p_later, lost);
  for (int i = 0; i < 3; ++i) {
    p_later[i] = add(p_later[i], convert<FixedLength>(T_later_now_.t[i], lost), lost);
  }
  FixedPixel later[2];
  return lost == 0 && detail::project_point(camera_, p_later, later, lost) && lost == 0 &&
         camera_.contains(later, kMargin);
}

}  // namespace cairn
