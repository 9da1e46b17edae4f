#pragma once

#include "cairn/geometry/fixed_rigid.hpp"
#include "cairn/numeric/float_bits.hpp"
#include "cairn/tracking/seed_motion.hpp"

namespace cairn {

/// StayingInView without floating point.
class FixedStayingInView {
 public:
  FixedStayingInView(const PinholeCamera<float>& camera, const Rigid<float>& T_later_now,
                     float depth_m);

  bool operator()(const Vector2<float>& pixel) const;

 private:
  FixedCamera camera_;
  detail::FixedMotionBetween T_later_now_;
  FixedLength depth_;
  bool usable_ = false;
};

}  // namespace cairn
